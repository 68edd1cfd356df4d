// SPDX-License-Identifier: BSD-3-Clause
// A closed box of boards that stands askew on the floor of a dark room, with a lamp in it: whatever
// the boards' thickness t and the size of the patches, no light gets out. In metres.

FLOAT t = 0.01;                                             // thickness of the boards

SCREEN <320, 240> EYEP (0.3, 0.3, 1.5) LOOKP (2, 1.6, 0.3) UP (0, 0, 1) FOV <70>

SURFACE 1 0 ; (0.7, 0.7, 0.7) 1 ; (0, 0, 0) 0, 1
SURFACE 2 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (500, 500, 500)

BEGIN GROUP "room"
    QUADRANGLE 1 (0,0,0) (4,0,0) (4,3,0) (0,3,0)
    QUADRANGLE 1 (0,0,2.5) (0,3,2.5) (4,3,2.5) (4,0,2.5)
    QUADRANGLE 1 (0,0,0) (0,3,0) (0,3,2.5) (0,0,2.5)
    QUADRANGLE 1 (4,0,0) (4,0,2.5) (4,3,2.5) (4,3,0)
    QUADRANGLE 1 (0,0,0) (0,0,2.5) (4,0,2.5) (4,0,0)
    QUADRANGLE 1 (0,3,0) (4,3,0) (4,3,2.5) (0,3,2.5)
END

// 1 m x 0.8 m x 0.9 m outside; the lid lies on the four boards
ROT_Z(17.3) * TRANS(2.03, 1.57, 0)
BEGIN
    BEGIN GROUP "box"
        BOX 1 (0, -0.4 + t/2, 0.45 - t/2) <0.5, t/2, 0.45 - t/2>
        BOX 1 (0, 0.4 - t/2, 0.45 - t/2) <0.5, t/2, 0.45 - t/2>
        BOX 1 (-0.5 + t/2, 0, 0.45 - t/2) <t/2, 0.4 - t, 0.45 - t/2>
        BOX 1 (0.5 - t/2, 0, 0.45 - t/2) <t/2, 0.4 - t, 0.45 - t/2>
        BOX 1 (0, 0, 0.9 - t/2) <0.5, 0.4, t/2>
    END
    BEGIN GROUP "lamp"
        QUADRANGLE 2 (-0.15,-0.15,0.7) (-0.15,0.15,0.7) (0.15,0.15,0.7) (0.15,-0.15,0.7)
    END
END
