// SPDX-License-Identifier: BSD-3-Clause
// The furnace: a closed unit cube whose six sides all send out E = 1 and reflect rho = 1/2.
// What leaves each of them is B = E / (1 - rho) = 2 everywhere, so every pixel has radiance 2 / pi.

FLOAT rho = 0.5, L = 1 / 3.14159265358979324;  // emitted radiance of E = 1

SCREEN <256, 256> EYEP (0.5, 0.1, 0.5) LOOKP (0.5, 1, 0.5) UP (0, 0, 1) FOV <90>

SURFACE 1 0 ; (1, 1, 1) rho ; (0, 0, 0) 0, 1 EMISSIVE (L, L, L)

// BOX looks outward; these look inward.
BEGIN GROUP "x0" QUADRANGLE 1 (0,0,0) (0,1,0) (0,1,1) (0,0,1) END
BEGIN GROUP "x1" QUADRANGLE 1 (1,0,0) (1,0,1) (1,1,1) (1,1,0) END
BEGIN GROUP "y0" QUADRANGLE 1 (0,0,0) (0,0,1) (1,0,1) (1,0,0) END
BEGIN GROUP "y1" QUADRANGLE 1 (0,1,0) (1,1,0) (1,1,1) (0,1,1) END
BEGIN GROUP "z0" QUADRANGLE 1 (0,0,0) (1,0,0) (1,1,0) (0,1,0) END
BEGIN GROUP "z1" QUADRANGLE 1 (0,0,1) (0,1,1) (1,1,1) (1,0,1) END
