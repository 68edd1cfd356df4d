// SPDX-License-Identifier: BSD-3-Clause
// A closed room of 4 x 4 x 3 m in which a ball goes by: TIME from 0 to 1 is a second. `still`
// stands, `ride` goes along with the ball.

FLOAT x = 0.8 + 2.4 * TIME;

CAMERA still = ( (2, 0.1, 1.4) (2, 3, 0.6) (0, 0, 1) 70 55 );
CAMERA ride = ( (x, 0.1, 1.4) (x, 3, 0.6) (0, 0, 1) 70 55 );

SURFACE 1 0 ; (0.75, 0.73, 0.70) 1 ; (0, 0, 0) 0, 1                      // walls and ceiling
SURFACE 2 0 ; (0.35, 0.28, 0.22) 1 ; (0, 0, 0) 0, 1                      // wooden floor
SURFACE 3 0 ; (0.75, 0.20, 0.10) 1 ; (0, 0, 0) 0, 1                      // the ball
SURFACE 4 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (30, 28, 25)         // the lamp

BEGIN GROUP "floor"   QUADRANGLE 2 (0,0,0) (4,0,0) (4,4,0) (0,4,0) END
BEGIN GROUP "ceiling" QUADRANGLE 1 (0,0,3) (0,4,3) (4,4,3) (4,0,3) END
BEGIN GROUP "walls"
    QUADRANGLE 1 (0,0,0) (0,4,0) (0,4,3) (0,0,3)
    QUADRANGLE 1 (4,0,0) (4,0,3) (4,4,3) (4,4,0)
    QUADRANGLE 1 (0,0,0) (0,0,3) (4,0,3) (4,0,0)
    QUADRANGLE 1 (0,4,0) (4,4,0) (4,4,3) (0,4,3)
END
BEGIN GROUP "lamp" QUADRANGLE 4 (1.7,1.7,2.95) (1.7,2.3,2.95) (2.3,2.3,2.95) (2.3,1.7,2.95) END
BEGIN GROUP "ball" SPHERE 3 (x, 2.6, 0.5) 0.5 END
