#include "client/tiles/tile_residency.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <queue>
#include <tuple>
#include <utility>

#include "common/tiling/tile_at.h"

namespace terrane {

void TileResidency::setRevision(const std::string& revision) {
  if (revision == revision_) return;
  revision_ = revision;
  evicted_.clear();
}

void TileResidency::add(const std::shared_ptr<const Tile>& tile, const ResidentTile& info, const std::string& revision,
                        std::size_t gpuBytes, const LastWanted& wanted) {
  const FacePath& path = tile->metadata.path;
  const auto [at, isNew] = tiles_.try_emplace(path);
  if (isNew) {
    ++countAtLevel_[static_cast<std::size_t>(path.level())];
    for (int level = 0; level < path.level(); ++level) ++descendants_[path.ancestor(level)];
  }
  evicted_.forget(path);
  Resident& resident = at->second;
  bytes_ -= resident.bytes;
  resident.info = info;
  resident.revision = revision;
  resident.ground = GroundMesh::fromTile(*tile);
  resident.mesh = tile;
  resident.bytes = gpuBytes + resident.ground.bytes();
  resident.wanted = wanted;
  bytes_ += resident.bytes;
}

const std::string* TileResidency::touch(const FacePath& path, const LastWanted& wanted) {
  const auto found = tiles_.find(path);
  if (found == tiles_.end()) return nullptr;
  found->second.wanted = wanted;
  return &found->second.revision;
}

const ResidentTile* TileResidency::find(const FacePath& path) const {
  const auto found = tiles_.find(path);
  return found == tiles_.end() ? evicted_.find(path) : &found->second.info;
}

std::shared_ptr<const Tile> TileResidency::mesh(const FacePath& path) const {
  const auto found = tiles_.find(path);
  return found == tiles_.end() ? nullptr : found->second.mesh.lock();
}

void TileResidency::remove(const FacePath& path) {
  const auto found = tiles_.find(path);
  bytes_ -= found->second.bytes;
  --countAtLevel_[static_cast<std::size_t>(path.level())];
  for (int level = 0; level < path.level(); ++level) {
    const auto above = descendants_.find(path.ancestor(level));
    if (--above->second == 0) descendants_.erase(above);
  }
  tiles_.erase(found);
}

std::vector<FacePath> TileResidency::evict(std::size_t budgetBytes, const std::vector<FacePath>& draw,
                                           const std::function<bool(const FacePath&, const LastWanted&)>& protects) {
  std::vector<FacePath> gone;
  if (bytes_ <= budgetBytes) return gone;
  ++drawMark_;
  for (const FacePath& path : draw) {
    if (const auto found = tiles_.find(path); found != tiles_.end()) found->second.drawnMark = drawMark_;
  }
  using Candidate = std::tuple<std::uint64_t, int, FacePath>;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  const auto consider = [&](const FacePath& path, const Resident& resident) {
    if (resident.drawnMark == drawMark_ || descendants_.contains(path) || protects(path, resident.wanted)) return;
    candidates.emplace(resident.wanted.call, -path.level(), path);
  };
  for (const auto& [path, resident] : tiles_) consider(path, resident);
  while (bytes_ > budgetBytes && !candidates.empty()) {
    const FacePath path = std::get<FacePath>(candidates.top());
    candidates.pop();
    const Resident& going = tiles_.at(path);
    if (going.revision == revision_) evicted_.remember(path, going.info);
    remove(path);
    gone.push_back(path);
    // The nearest resident ancestor may now be without descendants.
    for (int level = path.level() - 1; level >= 0; --level) {
      const auto above = tiles_.find(path.ancestor(level));
      if (above == tiles_.end()) continue;
      consider(above->first, above->second);
      break;
    }
  }
  return gone;
}

void TileResidency::clear() {
  tiles_.clear();
  evicted_.clear();
  descendants_.clear();
  std::fill(countAtLevel_.begin(), countAtLevel_.end(), 0);
  bytes_ = 0;
}

namespace {

std::optional<glm::dvec3> unitDirection(const glm::dvec3& direction) {
  const double length = glm::length(direction);
  if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
  return direction / length;
}

/// What is drawn under a tile of the finest level; where nothing is, the tile there that is of the level of the nearest
/// drawn one, morphed as that is. Precondition: something is drawn.
DrawnTile drawnAround(const FacePath& finest, const std::vector<DrawnTile>& drawn) {
  for (const DrawnTile& tile : drawn)
    if (finest.ancestor(tile.path.level()) == tile.path) return tile;
  std::unordered_map<FacePath, const DrawnTile*> coarsestIn;  // a drawn tile, or an ancestor of some
  for (const DrawnTile& tile : drawn) {
    for (int level = tile.path.level(); level >= 0; --level) {
      const DrawnTile*& coarsest = coarsestIn.try_emplace(tile.path.ancestor(level), &tile).first->second;
      if (tile.path.level() < coarsest->path.level()) coarsest = &tile;
    }
  }
  const auto levelOf = [](const DrawnTile& tile) { return tile.path.level(); };
  const DrawnTile* nearest = &*std::ranges::max_element(drawn, {}, levelOf);
  for (int level = levelOf(*nearest); level >= 0; --level) {
    const FacePath here = finest.ancestor(level);
    auto found = coarsestIn.find(here);
    for (const FacePath& beside : tilesAround(here))
      if (found == coarsestIn.end()) found = coarsestIn.find(beside);
    if (found == coarsestIn.end()) continue;
    nearest = found->second;
    break;
  }
  DrawnTile beyond{finest.ancestor(levelOf(*nearest)), {.own = nearest->morph.own}};
  beyond.morph.sides.fill(nearest->morph.own);
  return beyond;
}

}  // namespace

std::optional<TileResidency::Ground> TileResidency::groundBelow(const glm::dvec3& directionBody, double radiusMeters,
                                                                Scheme scheme) const {
  const auto direction = unitDirection(directionBody);
  if (!direction) return std::nullopt;
  const FacePath finest = tileAt(scheme, *direction, FacePath::kMaxLevel);
  for (int level = FacePath::kMaxLevel; level >= 0; --level) {
    if (countAtLevel_[static_cast<std::size_t>(level)] == 0) continue;
    const auto found = tiles_.find(finest.ancestor(level));
    if (found == tiles_.end()) continue;
    const glm::dvec2 at = placeInTile(found->first, *direction);
    const auto height = found->second.ground.heightMeters(*direction, at.x, at.y, radiusMeters);
    if (height) return Ground{*height, level};
  }
  return std::nullopt;
}

std::optional<double> TileResidency::drawnHeightBelow(const glm::dvec3& directionBody, double radiusMeters,
                                                      const std::vector<DrawnTile>& drawn) const {
  const auto direction = unitDirection(directionBody);
  if (!direction || drawn.empty()) return std::nullopt;
  DrawnTile tile = drawnAround(tileAt(drawn.front().path.scheme(), *direction, FacePath::kMaxLevel), drawn);
  auto found = tiles_.find(tile.path);
  for (; found == tiles_.end() && tile.path.level() > 0; found = tiles_.find(tile.path))
    tile = {tile.path.parent(), {}};
  if (found == tiles_.end()) return std::nullopt;
  const int level = tile.path.level();
  const glm::dvec2 at = placeInTile(tile.path, *direction);
  const GroundMesh& ground = found->second.ground;
  const auto above = level > 0 ? tiles_.find(tile.path.parent()) : tiles_.end();
  if (above == tiles_.end()) return ground.heightMeters(*direction, at.x, at.y, radiusMeters);
  return ground.morphedHeightMeters(*direction, at.x, at.y, radiusMeters, tile.morph, above->second.ground,
                                    tile.path.digit(level - 1));
}

}  // namespace terrane
