// SPDX-License-Identifier: BSD-3-Clause
// A dark room and a bright court, with a window of clear glass between them: all light comes in
// through the pane.
SCREEN <320, 240> EYEP (2.8, 0.4, 1.6) LOOKP (0.6, 2.0, 1.1) UP (0, 0, 1) FOV <75>
SURFACE 1 0 ; (0.75, 0.75, 0.72) 1 ; (0, 0, 0) 0, 1
SURFACE 2 0 ; (0.5, 0.42, 0.34) 1 ; (0, 0, 0) 0, 1
SURFACE 3 0 ; (0, 0, 0) 0 ; (0, 0, 0) 0, 1 ; (0.9, 0.95, 0.92) 1.5
SURFACE 4 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (6, 6.4, 7)
SURFACE 5 0 ; (0.6, 0.3, 0.2) 1 ; (0, 0, 0) 0, 1
BEGIN GROUP "room"
    QUADRANGLE 2 (0,0,0) (3,0,0) (3,3,0) (0,3,0)
    QUADRANGLE 1 (0,0,2.5) (0,3,2.5) (3,3,2.5) (3,0,2.5)
    QUADRANGLE 1 (3,0,0) (3,0,2.5) (3,3,2.5) (3,3,0)
    QUADRANGLE 1 (0,0,0) (0,0,2.5) (3,0,2.5) (3,0,0)
    QUADRANGLE 1 (0,3,0) (3,3,0) (3,3,2.5) (0,3,2.5)
END
BEGIN GROUP "wall"
    QUADRANGLE 1 (0,0,0) (0,3,0) (0,3,0.8) (0,0,0.8)
    QUADRANGLE 1 (0,0,2.1) (0,3,2.1) (0,3,2.5) (0,0,2.5)
    QUADRANGLE 1 (0,0,0.8) (0,0.6,0.8) (0,0.6,2.1) (0,0,2.1)
    QUADRANGLE 1 (0,2.4,0.8) (0,3,0.8) (0,3,2.1) (0,2.4,2.1)
END
BEGIN GROUP "pane" QUADRANGLE 3 (0,0.6,0.8) (0,2.4,0.8) (0,2.4,2.1) (0,0.6,2.1) END
BEGIN GROUP "court"
    QUADRANGLE 5 (-4,0,0) (0,0,0) (0,3,0) (-4,3,0)
    QUADRANGLE 1 (-4,0,0) (-4,3,0) (-4,3,4) (-4,0,4)
    QUADRANGLE 1 (-4,0,0) (-4,0,4) (0,0,4) (0,0,0)
    QUADRANGLE 1 (-4,3,0) (0,3,0) (0,3,4) (-4,3,4)
    QUADRANGLE 1 (0,0,2.5) (0,0,4) (0,3,4) (0,3,2.5)
    QUADRANGLE 4 (-4,0,4) (-4,3,4) (0,3,4) (0,0,4)
END
