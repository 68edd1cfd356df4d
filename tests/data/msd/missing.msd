INCLUDE "nowhere.msd" ;
