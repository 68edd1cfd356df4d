// SPDX-License-Identifier: BSD-3-Clause
// A bright room and a dark one under one ceiling and on one floor, a wall of thickness t between
// them and a table board through it: the dark room is dark. In metres.

FLOAT t = 0.01;                                             // thickness of the wall

SCREEN <320, 240> EYEP (3.7, 0.3, 1.5) LOOKP (2.1, 1.6, 0.6) UP (0, 0, 1) FOV <70>

SURFACE 1 0 ; (0.7, 0.7, 0.7) 1 ; (0, 0, 0) 0, 1
SURFACE 2 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (500, 500, 500)

BEGIN GROUP "rooms"
    QUADRANGLE 1 (0,0,0) (4,0,0) (4,3,0) (0,3,0)
    QUADRANGLE 1 (0,0,2.5) (0,3,2.5) (4,3,2.5) (4,0,2.5)
    QUADRANGLE 1 (0,0,0) (0,3,0) (0,3,2.5) (0,0,2.5)
    QUADRANGLE 1 (4,0,0) (4,0,2.5) (4,3,2.5) (4,3,0)
    QUADRANGLE 1 (0,0,0) (0,0,2.5) (4,0,2.5) (4,0,0)
    QUADRANGLE 1 (0,3,0) (4,3,0) (4,3,2.5) (0,3,2.5)
END
BEGIN GROUP "wall"
    BOX 1 (2 - t/2, 1.5, 1.25) <t/2, 1.5, 1.25>
END
BEGIN GROUP "board"
    BOX 1 (1.95, 1.5, 0.72) <0.65, 0.4, 0.02>
END
BEGIN GROUP "lamp"
    QUADRANGLE 2 (0.7,0.7,2.3) (0.7,1.2,2.3) (1.2,1.2,2.3) (1.2,0.7,2.3)
END
