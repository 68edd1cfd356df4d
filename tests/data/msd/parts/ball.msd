// Sees the names and surfaces of the file that includes it; its own do not go back.
SCREEN <8, 8> EYEP (0,0,0) LOOKP (1,0,0) UP (0,0,1) FOV <50>
ATT_POS_LIGHT (9,9,9) (9,9,9)
COLORRANGE 255
SURFACE 3 0 ; (51,51,51) 1 ; (0,0,0) 0, 1
SURFACE 1 0 ; (0,255,0) 0.5 ; (0,0,0) 0, 1
SPHERE 1 (0,0,0) size
INCLUDE leaf.msd ;
ENDFILE
