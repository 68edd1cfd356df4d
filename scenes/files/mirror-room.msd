// SPDX-License-Identifier: BSD-3-Clause
// A room whose one wall is a mirror, with a lamp that a screen hides from half of the floor: what
// lights that half comes by way of the mirror.
SCREEN <320, 240> EYEP (3.6, 0.4, 1.7) LOOKP (1.2, 2.2, 0.8) UP (0, 0, 1) FOV <70>
SURFACE 1 0 ; (0.7, 0.7, 0.68) 1 ; (0, 0, 0) 0, 1
SURFACE 2 0 ; (0.5, 0.42, 0.34) 1 ; (0, 0, 0) 0, 1
SURFACE 3 0 ; (0, 0, 0) 0 ; (0.9, 0.9, 0.9) 1, 100000
SURFACE 4 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (40, 38, 34)
SURFACE 5 0 ; (0.3, 0.45, 0.6) 1 ; (0, 0, 0) 0, 1
BEGIN GROUP "floor"   QUADRANGLE 2 (0,0,0) (4,0,0) (4,3,0) (0,3,0) END
BEGIN GROUP "ceiling" QUADRANGLE 1 (0,0,2.5) (0,3,2.5) (4,3,2.5) (4,0,2.5) END
BEGIN GROUP "mirror"  QUADRANGLE 3 (0,0,0) (0,3,0) (0,3,2.5) (0,0,2.5) END
BEGIN GROUP "walls"
    QUADRANGLE 1 (4,0,0) (4,0,2.5) (4,3,2.5) (4,3,0)
    QUADRANGLE 1 (0,0,0) (0,0,2.5) (4,0,2.5) (4,0,0)
    QUADRANGLE 1 (0,3,0) (4,3,0) (4,3,2.5) (0,3,2.5)
END
BEGIN GROUP "screen" BOX 5 (2.2, 1.2, 0.8) <0.03, 0.8, 0.8> END
BEGIN GROUP "lamp" QUADRANGLE 4 (0.8,1.0,2.49) (0.8,1.6,2.49) (1.4,1.6,2.49) (1.4,1.0,2.49) END
