"use strict";
// Draws the surface of a run with three.js: turned by hand, scrubbed through time. One .viewer element a run; its data
// (surface_view.py) stand in the script element that data-source names.
(function () {
  const root = document.documentElement;
  root.dataset.viewers = 0;
  const tell = (error) => { root.dataset.errors = (root.dataset.errors || "") + error + "; "; };
  window.addEventListener("error", (event) => tell(event.message));
  window.addEventListener("unhandledrejection", (event) => tell(event.reason));
  window.addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => { d.open = true; }));

  async function inflated(text) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // The integers that packed() took, column after column: n_columns arrays of equal length.
  async function unpacked(text, n_columns) {
    const planes = await inflated(text), all = planes.length / 4, n = all / n_columns;
    const columns = [];
    for (let c = 0; c < n_columns; ++c) {
      const column = new Int32Array(n);
      for (let i = 0, sum = 0; i < n; ++i) {
        const at = c * n + i;
        sum += planes[at] | planes[all + at] << 8 | planes[2 * all + at] << 16 | planes[3 * all + at] << 24;
        column[i] = sum;
      }
      columns.push(column);
    }
    return columns;
  }

  async function readTopology(packed) {
    return {
      triangles: await unpacked(packed.triangles, 3),
      labels: (await unpacked(packed.labels, 1))[0],
      colours: packed.colours ? await unpacked(packed.colours, 3) : null,
    };
  }

  async function readPoints(body) {
    const columns = await unpacked(body.points, 3);
    const points = new Float32Array(3 * columns[0].length);
    for (let i = 0; i < columns[0].length; ++i)
      for (let k = 0; k < 3; ++k)
        points[3 * i + k] = body.low[k] + body.step * columns[k][i];
    return points;
  }

  function colourOf(topology, t, palette) {
    if (topology.colours && topology.colours[0][t] >= 0)
      return topology.colours.map((column) => column[t] / 255);
    const label = topology.labels[t];
    const c = palette[label === 0 ? 0 : 1 + (label - 1) % (palette.length - 1)];
    return [c.r, c.g, c.b];
  }

  function faceNormals(positions) {
    const normals = new Float32Array(positions.length / 3);
    const a = new THREE.Vector3(), b = new THREE.Vector3(), c = new THREE.Vector3();
    for (let t = 0; t < normals.length / 3; ++t) {
      a.fromArray(positions, 9 * t);
      b.fromArray(positions, 9 * t + 3).sub(a);
      c.fromArray(positions, 9 * t + 6).sub(a);
      b.cross(c).toArray(normals, 3 * t);
    }
    return normals;
  }

  // Of each corner: the mean of the skin's around it where they differ little, else the triangle's own.
  function cornerNormals(topology, faces, n_points) {
    const n = topology.labels.length, sums = new Float32Array(3 * n_points), normals = new Float32Array(9 * n);
    for (let t = 0; t < n; ++t)
      for (let v = 0; v < 3 && topology.labels[t] === 0; ++v)
        for (let k = 0; k < 3; ++k)
          sums[3 * topology.triangles[v][t] + k] += faces[3 * t + k];
    const own = new THREE.Vector3(), mean = new THREE.Vector3();
    for (let t = 0; t < n; ++t)
      for (let v = 0; v < 3; ++v) {
        own.fromArray(faces, 3 * t).normalize();
        mean.fromArray(sums, 3 * topology.triangles[v][t]).normalize();
        (topology.labels[t] === 0 && mean.dot(own) > 0.8 ? mean : own).toArray(normals, 9 * t + 3 * v);
      }
    return normals;
  }

  function makeGeometry(topology, points, palette) {
    const n = topology.labels.length, positions = new Float32Array(9 * n), colours = new Float32Array(9 * n);
    for (let t = 0; t < n; ++t) {
      const colour = colourOf(topology, t, palette);
      for (let v = 0; v < 3; ++v)
        for (let k = 0; k < 3; ++k) {
          positions[9 * t + 3 * v + k] = points[3 * topology.triangles[v][t] + k];
          colours[9 * t + 3 * v + k] = colour[k];
        }
    }
    const geometry = new THREE.BufferGeometry();
    const normals = cornerNormals(topology, faceNormals(positions), points.length / 3);
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    return geometry;
  }

  async function readView(id) {
    const view = JSON.parse(document.getElementById(id).textContent);
    view.palette = view.palette.map((c) => new THREE.Color(c));
    view.topologies = await Promise.all(view.topologies.map(readTopology));
    return view;
  }

  async function show(element) {
    const view = await readView(element.dataset.source);
    const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    const canvas = renderer.domElement;
    element.querySelector(".canvas").appendChild(canvas);
    const scene = new THREE.Scene(), bodies = new THREE.Group();
    const camera = new THREE.PerspectiveCamera(30, 4 / 3, 0.01, 100);
    const lamp = new THREE.DirectionalLight(0xffffff, 0.65);
    lamp.position.set(-1, 1.5, 2);
    camera.up.set(0, 0, 1);
    camera.add(lamp);
    scene.background = new THREE.Color(0xffffff);
    scene.add(camera, bodies, new THREE.HemisphereLight(0xffffff, 0xb0b0b0, 0.55));
    const material = new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide });

    const draw = () => renderer.render(scene, camera);
    async function showFrame(index) {
      const frame = view.frames[index];
      const points = await Promise.all(frame.bodies.map(readPoints));
      if (Number(slider.value) !== index)
        return; // another one has been asked for meanwhile
      bodies.children.slice().forEach((mesh) => { bodies.remove(mesh); mesh.geometry.dispose(); });
      frame.bodies.forEach((body, i) => {
        bodies.add(new THREE.Mesh(makeGeometry(view.topologies[body.topology], points[i], view.palette), material));
      });
      element.querySelector("output").textContent = frame.time.toPrecision(4) + " s";
      draw();
    }

    const slider = element.querySelector("input"), play = element.querySelector(".play");
    slider.max = view.frames.length - 1;
    slider.value = 0;
    slider.addEventListener("input", () => showFrame(Number(slider.value)));
    await showFrame(0);

    const sphere = new THREE.Box3().setFromObject(bodies).getBoundingSphere(new THREE.Sphere());
    const controls = new THREE.OrbitControls(camera, canvas);
    function lookFromStart() {
      const from = new THREE.Vector3(0.5, -0.77, 0.39).multiplyScalar(4.4 * sphere.radius);
      camera.position.copy(sphere.center).add(from);
      camera.near = 0.05 * sphere.radius;
      camera.far = 100 * sphere.radius;
      controls.target.copy(sphere.center);
      controls.update();
    }
    function resize() {
      const width = element.clientWidth, height = Math.round(Math.min(0.62 * width, 560));
      renderer.setPixelRatio(window.devicePixelRatio || 1);
      renderer.setSize(width, height);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      draw();
    }
    controls.addEventListener("change", draw);
    element.querySelector(".home").addEventListener("click", () => { lookFromStart(); draw(); });
    window.addEventListener("resize", resize);
    lookFromStart();
    resize();

    let timer = null;
    play.addEventListener("click", () => {
      play.textContent = timer ? "Play" : "Stop";
      timer = timer ? clearInterval(timer) : setInterval(() => {
        slider.value = (Number(slider.value) + 1) % view.frames.length;
        showFrame(Number(slider.value));
      }, 120);
    });
    slider.value = view.frames.length - 1;
    await showFrame(view.frames.length - 1);
    element.dataset.triangles = bodies.children.reduce((n, m) => n + m.geometry.attributes.position.count / 3, 0);
    root.dataset.viewers = Number(root.dataset.viewers) + 1;
  }

  document.querySelectorAll(".viewer").forEach((element) => show(element).catch((error) => {
    element.querySelector(".canvas").textContent = "This browser draws no surfaces: " + error;
    tell(error);
  }));
})();
