// A smooth function from examples: constant, linear part, and Gaussians of their own widths that
// are added one by one.
//
// After Esposito, Marinaro, Oricchio and Scarpetta 2000, as Seo and Magnenat-Thalmann 2004 use it:
// a new Gaussian sits on the example that is worst predicted, the best of twenty random widths is
// kept, all weights are solved anew. What is best, and when to stop, is told by the leave-one-out
// residual, which a linear solve gives without leaving out: r_i / (1 - h_ii) (Allen 1974).
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace ecorche::inline v1 {

struct RadialNetwork {
  Eigen::MatrixXd centres;  // #Gaussians x #inputs
  Eigen::VectorXd widths;   // beta in exp(-beta |x - centre|^2)
  Eigen::VectorXd weights;  // constant, inputs, Gaussians
};

struct RadialOptions {
  int gaussians = 16;   // at most
  int tries = 20;       // widths a Gaussian
  double ridge = 1e-6;  // of the weights, relative to the examples' number
  std::uint32_t seed = 1;
};

// X: #examples x #inputs, about unit spread; y: #examples. `left_out`, when given: prediction of
// each example from the others (the Gaussians' places and widths kept). Throws
// std::invalid_argument for fewer than #inputs + 3 examples.
RadialNetwork learn_network(const Eigen::MatrixXd& X, const Eigen::VectorXd& y,
                            const RadialOptions& options = {}, Eigen::VectorXd* left_out = nullptr);

double evaluate(const RadialNetwork& network, const Eigen::VectorXd& x);

}  // namespace ecorche::inline v1
