// SPDX-License-Identifier: BSD-3-Clause
// A closed room of 4 x 4 x 3 m with no lamp that has a surface: a point light, and a spot that
// shines on a cube. Intensities in candela, lengths in metres, so results are in lux.

FLOAT w = 4, d = 4, h = 3;

SCREEN <640, 480> EYEP (w/2, 0.05, 1.6) LOOKP (w/2, d, 1.1) UP (0, 0, 1) FOV <80>

ATT_POS_LIGHT (180, 150, 110) (1.2, 1.4, 2.2)                              // a warm bulb
ATT_SPOT_LIGHT (900, 1000, 1200) (3.4, 1, 2.8) (-0.45, 1.2, -2.4) 40       // 40 degrees wide

SURFACE 1 0 ; (0.75, 0.73, 0.70) 1 ; (0, 0, 0) 0, 1       // walls and ceiling
SURFACE 2 0 ; (0.35, 0.28, 0.22) 1 ; (0, 0, 0) 0, 1       // wooden floor
SURFACE 3 0 ; (0.20, 0.35, 0.60) 1 ; (0, 0, 0) 0, 1       // blue cube

BEGIN GROUP "floor"   QUADRANGLE 2 (0,0,0) (w,0,0) (w,d,0) (0,d,0) END
BEGIN GROUP "ceiling" QUADRANGLE 1 (0,0,h) (0,d,h) (w,d,h) (w,0,h) END
BEGIN GROUP "walls"
    QUADRANGLE 1 (0,0,0) (0,d,0) (0,d,h) (0,0,h)
    QUADRANGLE 1 (w,0,0) (w,0,h) (w,d,h) (w,d,0)
    QUADRANGLE 1 (0,0,0) (0,0,h) (w,0,h) (w,0,0)
    QUADRANGLE 1 (0,d,0) (w,d,0) (w,d,h) (0,d,h)
END

ROT_Z(30) * TRANS(2.95, 2.2, 0)
BEGIN GROUP "cube"
    BOX 3 (0, 0, 0.35) <0.35, 0.35, 0.35>
END
