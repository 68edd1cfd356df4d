// wrong two files down
INCLUDE parts/wrong.msd ;
