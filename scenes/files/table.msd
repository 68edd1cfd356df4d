// SPDX-License-Identifier: BSD-3-Clause
// A table on thin legs, askew in a room of 4 x 4 x 2.6 m: shadows begin at the legs.
SCREEN <640, 480> EYEP (0.6, 0.5, 1.7) LOOKP (2.2, 2.2, 0.5) UP (0, 0, 1) FOV <70>
FLOAT w = 4, d = 4, h = 2.6;
SURFACE 1 0 ; (0.8, 0.8, 0.78) 1 ; (0, 0, 0) 0, 1
SURFACE 2 0 ; (0.55, 0.48, 0.40) 1 ; (0, 0, 0) 0, 1
SURFACE 3 0 ; (0.45, 0.30, 0.18) 1 ; (0, 0, 0) 0, 1
SURFACE 4 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (30, 28, 24)
BEGIN GROUP "floor"   QUADRANGLE 2 (0,0,0) (w,0,0) (w,d,0) (0,d,0) END
BEGIN GROUP "ceiling" QUADRANGLE 1 (0,0,h) (0,d,h) (w,d,h) (w,0,h) END
BEGIN GROUP "walls"
    QUADRANGLE 1 (0,0,0) (0,d,0) (0,d,h) (0,0,h)
    QUADRANGLE 1 (w,0,0) (w,0,h) (w,d,h) (w,d,0)
    QUADRANGLE 1 (0,0,0) (0,0,h) (w,0,h) (w,0,0)
    QUADRANGLE 1 (0,d,0) (w,d,0) (w,d,h) (0,d,h)
END
BEGIN GROUP "lamp" QUADRANGLE 4 (1.8,1.0,2.59) (1.8,1.6,2.59) (2.4,1.6,2.59) (2.4,1.0,2.59) END
ROT_Z(20) * TRANS(2.3, 2.3, 0)
BEGIN GROUP "table"
    BOX 3 (0, 0, 0.735) <0.7, 0.4, 0.015>
    BOX 3 (-0.65, -0.35, 0.36) <0.02, 0.02, 0.36>
    BOX 3 (0.65, -0.35, 0.36) <0.02, 0.02, 0.36>
    BOX 3 (0.65, 0.35, 0.36) <0.02, 0.02, 0.36>
    BOX 3 (-0.65, 0.35, 0.36) <0.02, 0.02, 0.36>
END
