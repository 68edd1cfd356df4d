// SPDX-License-Identifier: BSD-3-Clause
// A plinth of height 1 with its foot at the origin, z up; shapes.msd includes it. Its surface 1
// hides the one of the including file.

SURFACE 1 0 ; (0.62, 0.60, 0.57) 1 ; (0, 0, 0) 0, 1

BOX 1 (0, 0, 0.04) <0.21, 0.21, 0.04>
BOX 1 (0, 0, 0.51) <0.16, 0.16, 0.43>
BOX 1 (0, 0, 0.97) <0.19, 0.19, 0.03>
