SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1  BREPOBJ 1 "none.obj"
