// The Cornell box of Mitsuba (cbox.xml), assembled from its meshes; millimetres, y up.
// The reflectances are the usual RGB values for the measured spectra in cbox.xml; the lamp's
// radiance takes its 400-500, 500-600, 600-700 nm levels. The lamp hangs half a millimetre lower
// than its mesh, as in cbox.xml.
SCREEN <512, 512> EYEP (278, 273, -800) LOOKP (278, 273, -799) UP (0, 1, 0) FOV <39.3077>

SURFACE 1 0 ; (0.725, 0.71, 0.68) 1 ; (0, 0, 0) 0, 1     // white
SURFACE 2 0 ; (0.63, 0.065, 0.05) 1 ; (0, 0, 0) 0, 1     // red
SURFACE 3 0 ; (0.14, 0.45, 0.091) 1 ; (0, 0, 0) 0, 1     // green
SURFACE 4 0 ; (0.78, 0.78, 0.78) 1 ; (0, 0, 0) 0, 1 EMISSIVE (17, 12, 4)

TRANS(0, -0.5, 0) BREPOBJ 4 "meshes/cbox_luminaire.obj"
BREPOBJ 1 "meshes/cbox_floor.obj"
BREPOBJ 1 "meshes/cbox_ceiling.obj"
BREPOBJ 1 "meshes/cbox_back.obj"
BREPOBJ 3 "meshes/cbox_greenwall.obj"
BREPOBJ 2 "meshes/cbox_redwall.obj"
BREPOBJ 1 "meshes/cbox_smallbox.obj"
BREPOBJ 1 "meshes/cbox_largebox.obj"
