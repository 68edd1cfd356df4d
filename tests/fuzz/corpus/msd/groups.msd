SURFACE 1 0 ; (1,1,1) 0.5 ; (0,0,0) 0, 1
BEGIN GROUP "T\303\251 \x41\n" SPHERE 1 (0,0,0) 1 END /* c */ BEGIN group "in" SPHERE 1 (0,0,0) 1 // x
END
