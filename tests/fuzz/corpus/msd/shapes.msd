// SPDX-License-Identifier: BSD-3-Clause
// A closed gallery of 6 x 5 x 3 m, z up, that shows every object the reader knows, each on a
// plinth or hung up, and most ways to write one: names, matrices, blocks, OBJECT, REF, INCLUDE.

FLOAT  w = 6, d = 5, h = 3, r = 0.17;
VECTOR above = (0, 0, 1);
MATRIX tilt = ROT_X(25) * ROT_Z(20);
CAMERA corner = ( (0.4, 0.4, 1.9) (4.2, 4.4, 0.9) above 75 55 );

SCREEN <800, 600> EYEP (3, 0.15, 1.7) LOOKP (3, 4, 1.05) UP above FOV <82>

SURFACE 1 0 ; (0.80, 0.79, 0.76) 1 ; (0, 0, 0) 0, 1       // walls and ceiling
SURFACE 2 0 ; (0.45, 0.36, 0.28) 1 ; (0, 0, 0) 0, 1       // wooden floor
SURFACE 3 0 ; (0.70, 0.18, 0.14) 1 ; (0, 0, 0) 0, 1       // red
SURFACE 4 0 ; (0.16, 0.38, 0.62) 1 ; (0, 0, 0) 0, 1       // blue
SURFACE 5 0 ; (0.72, 0.58, 0.16) 1 ; (0, 0, 0) 0, 1       // yellow
SURFACE 6 0 ; (0.22, 0.52, 0.26) 1 ; (0, 0, 0) 0, 1       // green
SURFACE 7 0 ; (0.60, 0.60, 0.62) 1 ; (0, 0, 0) 0, 1       // grey
SURFACE 9 0 ; (0, 0, 0) 1 ; (0, 0, 0) 0, 1 EMISSIVE (36, 33, 28)

// The room. Its faces look inward.
BEGIN GROUP "floor"   QUADRANGLE 2 (0,0,0) (w,0,0) (w,d,0) (0,d,0) END
BEGIN GROUP "ceiling" QUADRANGLE 1 (0,0,h) (0,d,h) (w,d,h) (w,0,h) END
BEGIN GROUP "walls"
    QUADRANGLE 1 (0,0,0) (0,d,0) (0,d,h) (0,0,h)
    QUADRANGLE 1 (w,0,0) (w,0,h) (w,d,h) (w,d,0)
    QUADRANGLE 1 (0,0,0) (0,0,h) (w,0,h) (w,0,0)
    QUADRANGLE 1 (0,d,0) (w,d,0) (w,d,h) (0,d,h)
END

// Two round lamps 5 cm under the ceiling; a DISC is seen from where its normal points.
BEGIN GROUP "lamps"
    DISC 9 (1.8, 2.4, h - 0.05) (0, 0, -1) 0.3
    DISC 9 (4.2, 2.4, h - 0.05) (0, 0, -1) 0.3
END

// Plinths: the file is read for the first, and meant again by its name for the others.
TRANS(0.8, 3.9, 0) INCLUDE plinth.msd plinth ;
TRANS(1.9, 3.9, 0) REF plinth
TRANS(3.0, 3.9, 0) REF plinth
TRANS(4.1, 3.9, 0) REF plinth
TRANS(5.2, 3.9, 0) REF plinth
SCALE(1, 1, 0.6) * TRANS(1.3, 2.5, 0) REF plinth
SCALE(1, 1, 0.6) * TRANS(2.4, 2.5, 0) REF plinth
SCALE(1, 1, 0.6) * TRANS(3.6, 2.5, 0) REF plinth
SCALE(1, 1, 0.6) * TRANS(4.7, 2.5, 0) REF plinth

// Back row.
SPHERE        3 (0.8, 3.9, 1 + r) r
ELLIPSOID     4 (1.9, 3.9, 1.26) <0.15, 0.15, 0.26>
CONE          5 (3.0, 3.9, 1) (3.0, 3.9, 1.45) r
TORUS         6 (4.1, 3.9, 1.06) <0.13, 0.06>
GEN_CYLINDER  3 (5.2, 3.9, 1) (5.2, 3.9, 1.4) <r, 0.08>

// Front row.
ROT_Z(35) * TRANS(1.3, 2.5, 0.6) BOX 4 (0, 0, 0.14) <0.14, 0.14, 0.14>
TRANS(2.4, 2.5, 0.6) TETRAHEDRON 5 (-0.16, -0.12, 0) (0.16, -0.12, 0) (0, 0.18, 0) (0, 0, 0.3)
TRANS(3.6, 2.5, 0.6) CYLINDER_COAT 6 (0, 0, 0) (0, 0, 0.25) <0.15>       // open at the top
tilt * SCALE(0.17, 0.17, 0.17) * TRANS(4.7, 2.5, 0.79) BREPOBJ 3 "gem.obj"

// Pictures on the back wall, a hair before it: a square, a triangle, a slanted parallelogram.
OBJECT frame = BOX 7 (0, 0, 0) <0.36, 0.02, 0.36>;
TRANS(1.4, d - 0.03, 2.1) BEGIN GROUP "picture-1"
    REF frame
    QUADRANGLE 4 (-0.3, -0.03, -0.3) (0.3, -0.03, -0.3) (0.3, -0.03, 0.3) (-0.3, -0.03, 0.3)
END
TRANS(3.0, d - 0.03, 2.1) BEGIN GROUP "picture-2"
    REF frame
    TRIANGLE 3 (-0.3, -0.03, -0.3) (0.3, -0.03, -0.3) (0, -0.03, 0.3)
END
TRANS(4.6, d - 0.03, 2.1) BEGIN GROUP "picture-3"
    REF frame
    PARALLEL 6 (-0.3, -0.03, -0.25) (0.15, -0.03, -0.25) (-0.15, -0.03, 0.25)
END
ENDFILE
