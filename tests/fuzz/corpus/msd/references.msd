FLOAT x = 1;
OBJECT ball = SPHERE 1 (x, 0, 0) 1, pair = BEGIN REF ball TRANS(10,0,0) REF ball END;
DEF three REF pair SURFACE 1 0 ; (1,1,1) .2 ; (0,0,0) 0, 1 SPHERE 1 (7,0,0) 1 ENDDEF
SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1
TRANS(100,0,0) REF ball BEGIN FLOAT x = 50; use pair END TRANS(200,0,0) BEGIN TRANS(3,0,0) REF three END
