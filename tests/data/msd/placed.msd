// A prism in six places, an object between them: faces, or references.
SURFACE 1 0 ; (0.5, 0.5, 0.5) 1 ; (0, 0, 0) 0, 1
SURFACE 2 0 ; (0.2, 0.4, 0.6) 1 ; (0, 0, 0) 0, 1
OBJECT prism = BREPOBJ 2 "parts/prism.obj"
BREPOBJ 1 "parts/prism.obj"
SPHERE 1 (0, 0, 9) 1
TRANS(10, 0, 0) REF prism
QUADRANGLE 1 (0, 0, -5) (1, 0, -5) (1, 1, -5) (0, 1, -5)
SCALE(2, 3, 4) * TRANS(20, 0, 0) REF prism
SCALE(-1, 1, 1) * TRANS(30, 0, 0) BEGIN
    TRANS(0, 0, 1) REF prism
    TRIANGLE 2 (0, 0, -6) (1, 0, -6) (0, 1, -6)
END
TRANS(40, 0, 0) REF prism
TRANS(50, 0, 0) BREPOBJ 1 "parts/prism.obj"
