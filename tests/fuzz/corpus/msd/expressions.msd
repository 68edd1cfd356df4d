FLOAT a = 4, b2 = 1 / a, c_3 = -SQR(SQRT(a)) + POW(2, EXP(0)) * COS(TIME) - TAN(1) / SIN(1.5e-3);
VECTOR p = (a, b2, +c_3);
SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1
SPHERE 1 p SQR(a)
