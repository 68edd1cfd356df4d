
  INCLUDE "parts/../cycle.msd" ;
