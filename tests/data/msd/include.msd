// Includes a part twice under other transforms, once in another surface, and refers to it by name.
FLOAT size = 2;
SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1
SURFACE 2 0 ; (1,1,1) 0.25 ; (0,0,0) 0, 1
ATT_POS_LIGHT (1,1,1) (0,0,0)
INCLUDE parts/ball.msd ball ;
TRANS(10,0,0) INCLUDE "parts/ball.msd" other 2 ;
TRANS(20,0,0) REF ball
SPHERE 1 (30,0,0) 1
