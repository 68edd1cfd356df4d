// SPDX-License-Identifier: BSD-3-Clause
// A dark room with curved things that light is shut in or out by: a tube with a lid, a lamp in it; a
// ring on the floor, shut by a disc, a lamp in it; a lit tube that another one goes through; and in
// the wall to a bright room a ball and a closed tube, both half in either. Whatever the size of the
// patches, no light gets into the dark room. In metres.

SCREEN <320, 240> EYEP (3.7, 0.3, 1.9) LOOKP (1, 1.6, 0.3) UP (0, 0, 1) FOV <70>

SURFACE 1 0 ; (0.7, 0.7, 0.7) 1 ; (0, 0, 0) 0, 1
SURFACE 2 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (500, 500, 500)

BEGIN GROUP "rooms"
    QUADRANGLE 1 (-2,0,0) (4,0,0) (4,3,0) (-2,3,0)
    QUADRANGLE 1 (-2,0,2.5) (-2,3,2.5) (4,3,2.5) (4,0,2.5)
    QUADRANGLE 1 (-2,0,0) (-2,3,0) (-2,3,2.5) (-2,0,2.5)
    QUADRANGLE 1 (4,0,0) (4,0,2.5) (4,3,2.5) (4,3,0)
    QUADRANGLE 1 (-2,0,0) (-2,0,2.5) (4,0,2.5) (4,0,0)
    QUADRANGLE 1 (-2,3,0) (4,3,0) (4,3,2.5) (-2,3,2.5)
    QUADRANGLE 1 (0,0,0) (0,3,0) (0,3,2.5) (0,0,2.5)
END
BEGIN GROUP "in the wall"
    SPHERE 1 (0.07, 1.4, 1.2) 0.5
    GEN_CYLINDER 1 (-0.6, 2.4, 0.5) (0.7, 2.5, 0.55) <0.2>
END
BEGIN GROUP "tube"
    CYLINDER_COAT 1 (2.73, 2.17, 0) (2.73, 2.17, 0.9) <0.43>
    DISC 1 (2.73, 2.17, 0.9) (0, 0, 1) 0.43
END
BEGIN GROUP "ring"
    TORUS 1 (1.1, 0.7, 0.05) <0.5, 0.15>
    DISC 1 (1.1, 0.7, 0.1) (0, 0, 1) 0.5
END
BEGIN GROUP "two tubes"
    GEN_CYLINDER 1 (2.2, 0.8, 1.9) (3.8, 0.8, 1.9) <0.4>
    GEN_CYLINDER 1 (3.1, 0.8, 1.3) (3.1, 0.8, 2.4) <0.2>
END
BEGIN GROUP "lamps"
    QUADRANGLE 2 (-1.1,1.4,2.3) (-1.1,1.6,2.3) (-0.9,1.6,2.3) (-0.9,1.4,2.3)
    QUADRANGLE 2 (2.63,2.07,0.7) (2.63,2.27,0.7) (2.83,2.27,0.7) (2.83,2.07,0.7)
    QUADRANGLE 2 (1,0.6,0.08) (1,0.8,0.08) (1.2,0.8,0.08) (1.2,0.6,0.08)
    QUADRANGLE 2 (2.4,0.7,2) (2.4,0.9,2) (2.6,0.9,2) (2.6,0.7,2)
END
