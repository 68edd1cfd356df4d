MATRIX m = TRANS(10,0,0) * SCALE(2,2,-2), n = (m * ROT_X(30)) * ROT_Y(45) * ROT_Z(60);
SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1
MATRIX4X3(0,1,0, 0,0,1, 1,0,0, 10,20,30) * n BOX 1 (1,2,3) <1,2,3>
