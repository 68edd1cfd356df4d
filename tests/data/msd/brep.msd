SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1
TRANS(0,0,2) BREPOBJ 1 "parts/wedge.obj"
SCALE(1,1,-1) BEGIN GROUP "mirrored" BREPOBJ 1 "parts/wedge.obj" END
