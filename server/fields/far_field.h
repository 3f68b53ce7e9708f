#pragma once
// Cuts a program in two over a patch of ground: what varies slowly over it, to be evaluated at the nodes of the patch
// and expanded in polynomials (far_fit.h), and the rest, which is evaluated at each sample and added. Belongs to one
// thread. Body frame, metres.
//
// Far is an octave of noise whose wavelength is at least kFarOctaveRadii radii of the patch's ball, if the patch lies
// within one of its cells, where it is a polynomial of the position; a crater, basin or lava patch by far_feature.h,
// and a halo; nothing of rays, which depend on the sum of all mottling, nor of rocks. And only as much of it as a
// tolerance leaves room for: a polynomial of degree 5 misses the sixth power first, of an octave at most
//   kFarOctaveError amplitude (kFarOctaveRadii radius / wavelength)^6,
// the sum over the corners of a cell of what the worst direction of each adds, at the worst place and turn of the patch
// (far_field_test searches for it). What float32 rounds where samples are evaluated in full comes on top.

#include <span>
#include <vector>

#include "server/fields/far_expansion.h"
#include "server/fields/far_feature.h"
#include "server/fields/far_patch.h"

namespace terrane::lunar {

inline constexpr double kFarOctaveRadii = 8;
inline constexpr double kFarOctaveError = 1.2e-5;

class FarField {
 public:
  /// Chooses the octaves of the whole program, cut to its level, that a tolerance of heights leaves room for. Octaves
  /// are told apart by their place in the body's table, which begins at `table` and holds at most 64.
  void chooseOctaves(const Program& whole, const NoiseOctave* table, const FarPatch& patch, double toleranceMeters);
  /// Whether anything at all is far: else there is nothing to be won.
  bool isWorthwhile() const noexcept { return octaveCount_ >= kLeastOctaves; }

  /// What is to be evaluated at the nodes, of a program with the same body and level as was chosen for; and what is
  /// left of it, or of one of the levels beside it with the same gathered features, of which heights alone are wanted.
  /// Each valid until the next call of it.
  Program farOf(const Program& whole);
  /// Under lava that is known to cover all, nothing is.
  Program nearOf(const Program& whole, const FarExpansion& expansion);

  const FarPatch& patch() const noexcept { return patch_; }
  /// Of heights, by what was chosen and what farOf took.
  double errorMeters() const noexcept { return octaveError_ + featureError_; }

 private:
  static constexpr int kLeastOctaves = 2;
  /// Of the tolerance: what one may take, so that all together stay within.
  static constexpr double kOctaveShare = 0.25, kFeatureShare = 1.0 / 16;

  /// One side of the cut.
  struct Part {
    std::vector<NoiseOctave> octaves;
    std::vector<NoiseGroup> groups;
    std::vector<Basin> basins;
    std::vector<LavaPatch> patches;
    std::vector<FeatureRun> runs;
    std::vector<HaloRun> halos;
    void clear();
    /// All but basins and lava patches, which every level shows.
    void clearOfLevel();
    void apply(Program& program) const;
  };

  bool fitsOneCell(const NoiseGroup& group, const NoiseOctave& octave) const noexcept;
  std::uint64_t bitOf(const NoiseOctave& octave) const noexcept {
    return std::uint64_t{1} << static_cast<unsigned>(&octave - table_);
  }
  double missedOf(double inverseWavelength) const noexcept;
  /// Whether a part that is never further from its polynomial than this is to be far.
  bool accepts(double errorMeters) const noexcept { return errorMeters <= kFeatureShare * tolerance_; }
  double errorOf(FeatureStage stage, const Feature& feature, const Program& atLevel) const noexcept;
  /// Decides for all features of a program.
  void judgeCraters(const Program& whole);
  /// One that was not judged is near: it is what only finer levels show.
  bool isJudgedFar(const Feature& feature) const noexcept;
  bool isChosen(const NoiseOctave& octave) const noexcept { return (farOctaves_ & bitOf(octave)) != 0; }
  std::size_t chooseIn(const NoiseGroup& group, bool keepLast);
  double errorIn(const NoiseGroup& group, const NoiseOctave* last) const noexcept;
  void takeOctaves(const Program& whole, bool far, Part& out) const;
  /// Parts basins and lava patches between far_ and near_.
  void partLandmarks(const Program& whole);
  void takeCraters(const Program& whole, bool far, Part& out) const;
  void takeHalos(const Program& whole, bool far, Part& out) const;
  /// Leaves of what is near only the lava's octaves, as relief, and what is younger.
  static void floodNear(Part& near);

  FarPatch patch_;
  const NoiseOctave* table_ = nullptr;
  std::uint64_t farOctaves_ = 0;
  int octaveCount_ = 0;
  double octaveError_ = 0, featureError_ = 0;
  double tolerance_ = 0;
  Part far_, near_;
  /// Features that lie together in memory and were judged; the levels beside cut them into other runs.
  struct Judged {
    const Feature* features;
    std::size_t count, begin;  ///< in verdicts_
    const Feature* end() const noexcept { return features + count; }
  };
  std::vector<Judged> judged_;
  std::vector<char> verdicts_;
};

}  // namespace terrane::lunar
