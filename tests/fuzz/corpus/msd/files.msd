INCLUDE a/b-c.msd name 1 ;
SURFACE 1 0;(1,1,1)1;(0,0,0)0,1 BREPOBJ 1 "x.obj"
