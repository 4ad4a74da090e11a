// SPDX-License-Identifier: MIT
// What two shapes that join with tangents or curvatures may differ in.
#pragma once

namespace batten {

// R(s) = λ(s) C(φ(s)) in homogeneous coordinates, C run towards the joint and past it, has the
// point, tangent and curvature of C at s = 0 whatever λ and φ are; what counts of them are
//  λ(0) = alpha > 0, the scale of the weights;  φ′(0) = beta > 0, the ratio of the speeds;
//  λ′(0) = eta and λ″(0) = eta2, which change weights alone;  φ″(0) = beta2.
// All of alpha = beta = 1, eta = 0 is C¹ (and C² with beta2 = eta2 = 0) in homogeneous coordinates;
// eta = eta2 = 0 is all there is without weights. [Farin 2002, §12.8; Hohmeyer & Barsky 1989]
struct JoinFreedom {
  double alpha = 1, beta = 1, eta = 0, beta2 = 0, eta2 = 0;
};

}  // namespace batten
