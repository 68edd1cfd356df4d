SPHERE 3 (1,0,0) size / 2
