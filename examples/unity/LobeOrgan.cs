// An organ in Unity. Our tests run it against a stand-in for UnityEngine (tests/csharp/unity_stub.cs); there
// is no Unity on our machines. Put liblobe_c.so (Linux) and the files of capi/csharp into Assets/Plugins, and
// this file on a GameObject with MeshFilter and MeshRenderer.
using Lobe;
using UnityEngine;
using UnityEngine.Rendering;

public sealed class LobeOrgan : MonoBehaviour {
  public string scene = "data/scenes/liver_hands.json";
  public Transform hand;               // leads tool 1
  public float radius = 0.015f;        // [m] of what it takes hold of
  public string saved = "organ.lobe";  // F5 keeps the organ as it is in this file, F9 goes back to it

  Organ organ;
  Mesh mesh;
  ulong topology;
  readonly Surface surface = new Surface();

  void Start() {
    // Unity is left-handed, with y up.
    organ = new Organ(scene, new Options { Axes = new double[] { 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0 } });
    mesh = new Mesh { indexFormat = IndexFormat.UInt32 };
    mesh.MarkDynamic();
    GetComponent<MeshFilter>().mesh = mesh;
    organ.Start();
  }

  double[] PoseOfHand() {
    var x = transform.InverseTransformPoint(hand.position);
    return new double[] { x.x, x.y, x.z, 0, 0, 0, 1 };
  }

  void Update() {
    if (organ == null)
      return;
    var pose = PoseOfHand();
    if (Input.GetMouseButtonDown(0))
      organ.Grasp(1, new[] { pose[0], pose[1], pose[2] }, radius);
    if (Input.GetMouseButton(0))
      organ.Move(1, pose);
    if (Input.GetMouseButtonUp(0))
      organ.Release(1);
    if (Input.GetKeyDown(KeyCode.F5))
      organ.Save(saved);
    if (Input.GetKeyDown(KeyCode.F9))
      organ.Restore(saved);
    if (organ.Update(surface))
      Show();
  }

  void Show() {
    int count = surface.Positions.Length;
    bool changed = surface.Topology != topology || mesh.vertexCount == 0;
    if (changed) {
      mesh.Clear();
      mesh.SetVertexBufferParams(count / 3,
                                 new VertexAttributeDescriptor(VertexAttribute.Position, stream: 0),
                                 new VertexAttributeDescriptor(VertexAttribute.Normal, stream: 1));
    }
    mesh.SetVertexBufferData(surface.Positions, 0, 0, count, 0);
    mesh.SetVertexBufferData(surface.Normals, 0, 0, count, 1);
    if (changed)
      mesh.SetIndices(surface.Indices, MeshTopology.Triangles, 0);
    topology = surface.Topology;
    mesh.RecalculateBounds();
  }

  void OnDestroy() {
    if (organ != null)
      organ.Dispose();
  }
}
