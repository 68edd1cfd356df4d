BEGIN INCLUDE "cycle2.msd" ; END
