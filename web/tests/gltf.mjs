// SPDX-License-Identifier: GPL-3.0-or-later
// Prints data of a .glb by three.js: the size of each mesh in meters, and world positions, colors
// and the attribute _ALONG of the first one. tests/web/test_gltf.py runs it.
import { readFile } from 'node:fs/promises';

import { Box3 } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

const { buffer, byteOffset, byteLength } = await readFile(process.argv[2]);
const { scene } = await new GLTFLoader().parseAsync(buffer.slice(byteOffset, byteOffset + byteLength), '');
scene.updateMatrixWorld(true);
const meshes = [];
scene.traverse((each) => {
  if (each.isMesh) meshes.push(each);
});
const [first] = meshes;
const { position, color, _along } = first.geometry.attributes;
console.log(
  JSON.stringify({
    names: meshes.map(({ name }) => name),
    size: new Box3().setFromObject(scene).getSize(scene.position.clone()).toArray(),
    usesColors: first.material.vertexColors,
    places: [...position.clone().applyMatrix4(first.matrixWorld).array],
    colors: [...color.array],
    channels: color.itemSize,
    values: _along ? [..._along.array] : null,
  }),
);
