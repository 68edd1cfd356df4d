// SPDX-License-Identifier: BSD-3-Clause
// The Cornell box: the published measurements in metres, y up, open towards the eye.
// 19 faces, each seen from its front inside the room or outside a block.

SCREEN <512, 512> EYEP (2.78, 2.73, -8) LOOKP (2.78, 2.73, 0) UP (0, 1, 0) FOV <39.3077>

SURFACE 1 0 ; (0.725, 0.71, 0.68) 1 ; (0, 0, 0) 0, 1       // white
SURFACE 2 0 ; (0.63, 0.065, 0.05) 1 ; (0, 0, 0) 0, 1       // red
SURFACE 3 0 ; (0.14, 0.45, 0.091) 1 ; (0, 0, 0) 0, 1       // green
SURFACE 4 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (17, 12, 4)

BEGIN GROUP "lamp" // The lamp fills the hole in the ceiling and shines down.
    QUADRANGLE 4 (3.43, 5.488, 2.27) (3.43, 5.488, 3.32) (2.13, 5.488, 3.32) (2.13, 5.488, 2.27)
END

BEGIN GROUP "floor"
    QUADRANGLE 1 (5.528, 0, 0) (0, 0, 0) (0, 0, 5.592) (5.496, 0, 5.592)
END

BEGIN GROUP "ceiling" // Four pieces around the lamp.
    QUADRANGLE 1 (5.56, 5.488, 0) (5.56, 5.488, 2.27) (0, 5.488, 2.27) (0, 5.488, 0)
    QUADRANGLE 1 (5.56, 5.488, 3.32) (5.56, 5.488, 5.592) (0, 5.488, 5.592) (0, 5.488, 3.32)
    QUADRANGLE 1 (5.56, 5.488, 2.27) (5.56, 5.488, 3.32) (3.43, 5.488, 3.32) (3.43, 5.488, 2.27)
    QUADRANGLE 1 (2.13, 5.488, 2.27) (2.13, 5.488, 3.32) (0, 5.488, 3.32) (0, 5.488, 2.27)
END

BEGIN GROUP "back"
    QUADRANGLE 1 (5.496, 0, 5.592) (0, 0, 5.592) (0, 5.488, 5.592) (5.56, 5.488, 5.592)
END

BEGIN GROUP "green-wall"
    QUADRANGLE 3 (0, 0, 5.592) (0, 0, 0) (0, 5.488, 0) (0, 5.488, 5.592)
END

BEGIN GROUP "red-wall" // Its four corners are not in one plane, as in the published data.
    QUADRANGLE 2 (5.528, 0, 0) (5.496, 0, 5.592) (5.56, 5.488, 5.592) (5.56, 5.488, 0)
END

BEGIN GROUP "short-block"
    QUADRANGLE 1 (1.3, 1.65, 0.65) (0.82, 1.65, 2.25) (2.4, 1.65, 2.72) (2.9, 1.65, 1.14)
    QUADRANGLE 1 (2.9, 0, 1.14) (2.9, 1.65, 1.14) (2.4, 1.65, 2.72) (2.4, 0, 2.72)
    QUADRANGLE 1 (1.3, 0, 0.65) (1.3, 1.65, 0.65) (2.9, 1.65, 1.14) (2.9, 0, 1.14)
    QUADRANGLE 1 (0.82, 0, 2.25) (0.82, 1.65, 2.25) (1.3, 1.65, 0.65) (1.3, 0, 0.65)
    QUADRANGLE 1 (2.4, 0, 2.72) (2.4, 1.65, 2.72) (0.82, 1.65, 2.25) (0.82, 0, 2.25)
END

BEGIN GROUP "tall-block"
    QUADRANGLE 1 (4.23, 3.3, 2.47) (2.65, 3.3, 2.96) (3.14, 3.3, 4.56) (4.72, 3.3, 4.06)
    QUADRANGLE 1 (4.23, 0, 2.47) (4.23, 3.3, 2.47) (4.72, 3.3, 4.06) (4.72, 0, 4.06)
    QUADRANGLE 1 (4.72, 0, 4.06) (4.72, 3.3, 4.06) (3.14, 3.3, 4.56) (3.14, 0, 4.56)
    QUADRANGLE 1 (3.14, 0, 4.56) (3.14, 3.3, 4.56) (2.65, 3.3, 2.96) (2.65, 0, 2.96)
    QUADRANGLE 1 (2.65, 0, 2.96) (2.65, 3.3, 2.96) (4.23, 3.3, 2.47) (4.23, 0, 2.47)
END
