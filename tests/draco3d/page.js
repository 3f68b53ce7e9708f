// Prints one HTML page that holds the decoder, decode.js and every sample of a folder, and shows what decode.js prints.
const fs = require('fs'), path = require('path');
const folder = process.argv[2], package_ = path.dirname(require.resolve('draco3d/package.json'));
const base64 = (file) => fs.readFileSync(file).toString('base64');
const samples = fs.readdirSync(folder).filter((name) => name.endsWith('.bin')).sort()
  .map((name) => [name, base64(path.join(folder, name))]);
console.log(`<!doctype html><meta charset="utf-8"><title>draco3d</title><pre id="result">running</pre>
<script>${fs.readFileSync(path.join(package_, 'draco_decoder_nodejs.js'))}</script>
<script>${fs.readFileSync(path.join(__dirname, 'decode.js'))}</script>
<script>
const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
const show = (text) => { document.getElementById('result').textContent = text; };
// Compiled at once, so that all is done when the page counts as loaded.
const binary = new WebAssembly.Module(bytes('${base64(path.join(package_, 'draco_decoder.wasm'))}'));
DracoDecoderModule({instantiateWasm: (imports, done) => {
  const instance = new WebAssembly.Instance(binary, imports);
  done(instance);
  return instance.exports;
}})
  .then((draco) => show(compareAll(draco, ${JSON.stringify(samples)}.map(([name, text]) => [name, bytes(text)])).join('\\n')))
  .catch((failure) => show('draco3d: ' + failure.message));
</script>`);
