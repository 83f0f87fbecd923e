// SPDX-License-Identifier: GPL-3.0-or-later
// Declares the parts of three.js that the page uses, for the type check of its code.
export class Matrix4 { fromArray(values: ArrayLike<number>): this; }
export class Vector3 { constructor(x: number, y: number, z: number); fromArray(values: ArrayLike<number>): this; }
export class BufferAttribute { constructor(array: Float32Array | Uint32Array, size: number); array: Float32Array | Uint32Array; needsUpdate: boolean; }
export class BufferGeometry {
  attributes: Record<string, BufferAttribute>;
  setIndex(index: BufferAttribute): void;
  setAttribute(name: string, attribute: BufferAttribute): this;
  dispose(): void;
}
export class RawShaderMaterial {
  constructor(parameters: object);
  uniforms: Record<string, {value: any}>;
  dispose(): void;
}
export class Object3D { visible: boolean; frustumCulled: boolean; autoUpdate: boolean; add(child: Object3D): void; remove(child: Object3D): void; }
export class Mesh extends Object3D { constructor(geometry: BufferGeometry, material: RawShaderMaterial); geometry: BufferGeometry; material: RawShaderMaterial; }
export class Scene extends Object3D {}
export class Camera extends Object3D {}
export class WebGLRenderer {
  constructor(parameters: object);
  autoClear: boolean;
  debug: {checkShaderErrors: boolean};
  domElement: HTMLCanvasElement;
  getPixelRatio(): number;
  setPixelRatio(ratio: number): void;
  setScissorTest(on: boolean): void;
  setSize(width: number, height: number, style: boolean): void;
  setViewport(x: number, y: number, width: number, height: number): void;
  setScissor(x: number, y: number, width: number, height: number): void;
  setClearColor(color: number, alpha: number): void;
  clear(): void;
  render(scene: Scene, camera: Camera): void;
}
export const DoubleSide: number;
