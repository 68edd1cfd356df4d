// SPDX-License-Identifier: BSD-3-Clause
// Two rooms joined by a door, the lamp in the left one only.
SCREEN <640, 480> EYEP (4.6, 0.4, 1.6) LOOKP (2.6, 2.6, 0.9) UP (0, 0, 1) FOV <80>
SURFACE 1 0 ; (0.8, 0.8, 0.78) 1 ; (0, 0, 0) 0, 1
SURFACE 2 0 ; (0.55, 0.48, 0.40) 1 ; (0, 0, 0) 0, 1
SURFACE 3 0 ; (0.45, 0.30, 0.18) 1 ; (0, 0, 0) 0, 1
SURFACE 4 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (60, 56, 48)
BEGIN GROUP "floor"   QUADRANGLE 2 (0,0,0) (5,0,0) (5,3,0) (0,3,0) END
BEGIN GROUP "ceiling" QUADRANGLE 1 (0,0,2.5) (0,3,2.5) (5,3,2.5) (5,0,2.5) END
BEGIN GROUP "walls"
    QUADRANGLE 1 (0,0,0) (0,3,0) (0,3,2.5) (0,0,2.5)
    QUADRANGLE 1 (5,0,0) (5,0,2.5) (5,3,2.5) (5,3,0)
    QUADRANGLE 1 (0,0,0) (0,0,2.5) (5,0,2.5) (5,0,0)
    QUADRANGLE 1 (0,3,0) (5,3,0) (5,3,2.5) (0,3,2.5)
END
BEGIN GROUP "partition"
    BOX 1 (2.5, 0.6, 1.25) <0.06, 0.6, 1.25>
    BOX 1 (2.5, 2.55, 1.25) <0.06, 0.45, 1.25>
    BOX 1 (2.5, 1.65, 2.25) <0.06, 0.45, 0.25>
END
BEGIN GROUP "lamp" QUADRANGLE 4 (0.9,1.2,2.49) (0.9,1.7,2.49) (1.4,1.7,2.49) (1.4,1.2,2.49) END
ROT_Z(12) * TRANS(3.7, 2.0, 0)
BEGIN GROUP "table"
    BOX 3 (0, 0, 0.735) <0.5, 0.35, 0.015>
    BOX 3 (-0.45, -0.3, 0.36) <0.02, 0.02, 0.36>
    BOX 3 (0.45, -0.3, 0.36) <0.02, 0.02, 0.36>
    BOX 3 (0.45, 0.3, 0.36) <0.02, 0.02, 0.36>
    BOX 3 (-0.45, 0.3, 0.36) <0.02, 0.02, 0.36>
END
