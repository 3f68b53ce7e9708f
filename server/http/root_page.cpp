#include "server/http/root_page.h"

#include <fmt/format.h>

#include <string_view>

#include "proto/tile_url.h"

namespace terrane {
namespace {

constexpr std::string_view kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Terrane: {name}</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; max-width: 46rem; margin: 2rem auto; padding: 0 1rem; color: #222; background: #fff; }}
table {{ border-collapse: collapse; margin: 1rem 0; }}
th, td {{ text-align: left; padding: .25rem 1rem .25rem 0; border-bottom: 1px solid #ddd; }}
code {{ background: #f2f2f2; padding: .1rem .3rem; border-radius: 3px; }}
@media (prefers-color-scheme: dark) {{
  body {{ color: #ddd; background: #161616; }} code {{ background: #2a2a2a; }} a {{ color: #8ab4f8; }} th, td {{ border-color: #444; }}
}}
</style>
</head>
<body>
<h1>Terrane: {name}</h1>
<p>{summary}</p>
<p>This server computes terrain tiles on demand: binary glTF with Draco compression, one URL for each tile, cacheable for ever.</p>
<h2>Look at it</h2>
<p>With the native viewer, and this page's address:</p>
<p><code>terrane-view --server http://HOST:PORT</code></p>
<h2>Bodies</h2>
<table>
<tr><th>Body</th><th>Radius</th><th>Levels</th><th>Coarsest tiles</th></tr>
)";

constexpr std::string_view kTail = R"(</table>
<h2>Routes</h2>
<table>
<tr><td><a href="/v1/scene.json">/v1/scene.json</a></td><td>bodies, revisions, limits, effects</td></tr>
<tr><td><code>/v1/{{revision}}/{{body}}/{{scheme}}/{{face}}[/{{digits}}].glb</code></td><td>a tile; digits 0 to 3, one for each level</td></tr>
<tr><td><a href="/healthz">/healthz</a>, <a href="/readyz">/readyz</a>, <a href="/metrics">/metrics</a></td><td>for whoever watches the server</td></tr>
</table>
</body>
</html>
)";

std::string escapeHtml(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace

std::string rootPage(const SceneInfo& scene) {
  using fmt::arg;
  std::string page =
      fmt::format(fmt::runtime(kHead), arg("name", escapeHtml(scene.name)), arg("summary", escapeHtml(scene.summary)));
  for (const BodyInfo& body : scene.bodies) {
    std::string links;
    const Scheme scheme = body.selection.scheme;
    for (int face = 0; face < faceCount(scheme); ++face) {
      const FacePath path = FacePath::wholeFace(scheme, face);
      links += fmt::format("<a href=\"{}\">{}</a> ", tileTarget({body.revision, body.name, path}), path.text());
    }
    page += fmt::format("<tr><td>{}</td><td>{:.10g} km</td><td>0 to {}</td><td>{}</td></tr>\n", escapeHtml(body.name),
                        body.selection.radiusMeters / 1000, body.selection.maxLevel, links);
  }
  page += fmt::format(fmt::runtime(kTail));
  return page;
}

}  // namespace terrane
