#include "lobe_cholmod/cholmod_factor.h"

#include <Eigen/CholmodSupport>

namespace lobe {
namespace {

class Cholmod : public SparseFactor {
 public:
  Cholmod() {
    factor_.cholmod().nmethods = 1;
    factor_.cholmod().method[0].ordering = CHOLMOD_METIS;
    factor_.cholmod().print = 0;  // the solver damps and reports matrices that are not positive definite
  }
  const char* name() const override { return "CHOLMOD supernodal LLT, METIS nested dissection"; }
  bool takes_indefinite() const override { return false; }
  void analyse(const Matrix& A) override {
    factor_.analyzePattern(A);
    nonzeros_ = static_cast<long long>(factor_.cholmod().lnz);
  }
  bool factorise(const Matrix& A, Eigen::Index) override {
    factor_.factorize(A);
    return factor_.info() == Eigen::Success;
  }
  Eigen::Index size() const override { return factor_.rows(); }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const override { return factor_.solve(b); }
  long long nonzeros() const override { return nonzeros_; }

 private:
  Eigen::CholmodSupernodalLLT<Matrix, Eigen::Lower> factor_;
  long long nonzeros_ = 0;
};

}  // namespace

std::unique_ptr<SparseFactor> make_cholmod() { return std::make_unique<Cholmod>(); }

}  // namespace lobe
