// An organ in Unity. NOT RUN by lobe's authors, who have no Unity: a sketch of the calls of lobe_c.h from C#.
// Put liblobe_c.so (Linux) into Assets/Plugins, this file on a GameObject with MeshFilter and MeshRenderer.
using System;
using System.Runtime.InteropServices;
using UnityEngine;
using UnityEngine.Rendering;

public sealed class LobeOrgan : MonoBehaviour {
  public string scene = "data/scenes/liver_hands.json";
  public Transform hand;            // leads tool 1
  public float radius = 0.015f;     // [m] of what it takes hold of
  public string saved = "organ.lobe";  // F5 keeps the organ as it is in this file, F9 goes back to it

  [StructLayout(LayoutKind.Sequential)] struct Options {
    public uint size, threads;
    public double frame, speed;
    public uint unpaced, paused;
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 12)] public double[] axes;
  }
  [StructLayout(LayoutKind.Sequential)] struct Surface {
    public uint size, vertices, triangles;
    public ulong frame, topology;
    public double time;
    public IntPtr position, normal, index, region, cut, owner;
  }

  const string Library = "lobe_c";
  [DllImport(Library)] static extern int lobe_open(string file, ref Options options, out IntPtr session);
  [DllImport(Library)] static extern void lobe_close(IntPtr session);
  [DllImport(Library)] static extern int lobe_start(IntPtr session);
  [DllImport(Library)] static extern int lobe_grasp(IntPtr session, uint tool, double[] point, double radius);
  [DllImport(Library)] static extern int lobe_move(IntPtr session, uint tool, double[] pose);
  [DllImport(Library)] static extern int lobe_release(IntPtr session, uint tool);
  [DllImport(Library)] static extern int lobe_surface_acquire(IntPtr session, ref Surface surface);
  [DllImport(Library)] static extern void lobe_surface_release(IntPtr session, ref Surface surface);
  [DllImport(Library)] static extern int lobe_save(IntPtr session, string file);
  [DllImport(Library)] static extern int lobe_restore(IntPtr session, string file);
  [DllImport(Library)] static extern IntPtr lobe_last_error();

  IntPtr session;
  Mesh mesh;
  ulong topology;
  float[] positions = new float[0], normals = new float[0];
  int[] indices = new int[0];

  static void Check(int status) {
    if (status != 0) throw new Exception(Marshal.PtrToStringUTF8(lobe_last_error()));
  }

  void Start() {
    // Unity: left-handed, y up.
    var options = new Options { size = (uint)Marshal.SizeOf<Options>(),
                                axes = new double[] { 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0 } };
    Check(lobe_open(scene, ref options, out session));
    mesh = new Mesh { indexFormat = IndexFormat.UInt32 };
    mesh.MarkDynamic();
    GetComponent<MeshFilter>().mesh = mesh;
    lobe_start(session);
  }

  double[] PoseOfHand() {
    var x = transform.InverseTransformPoint(hand.position);
    return new double[] { x.x, x.y, x.z, 0, 0, 0, 1 };
  }

  void Update() {
    if (session == IntPtr.Zero) return;
    var pose = PoseOfHand();
    if (Input.GetMouseButtonDown(0)) lobe_grasp(session, 1, new[] { pose[0], pose[1], pose[2] }, radius);
    if (Input.GetMouseButton(0)) lobe_move(session, 1, pose);
    if (Input.GetMouseButtonUp(0)) lobe_release(session, 1);
    if (Input.GetKeyDown(KeyCode.F5)) Check(lobe_save(session, saved));
    if (Input.GetKeyDown(KeyCode.F9)) Check(lobe_restore(session, saved));

    var surface = new Surface { size = (uint)Marshal.SizeOf<Surface>() };
    if (lobe_surface_acquire(session, ref surface) != 0) return;
    int count = (int)surface.vertices * 3;
    bool changed = surface.topology != topology;
    if (positions.Length != count) { positions = new float[count]; normals = new float[count]; }
    Marshal.Copy(surface.position, positions, 0, count);
    Marshal.Copy(surface.normal, normals, 0, count);
    if (changed) {
      indices = new int[surface.triangles * 3];
      Marshal.Copy(surface.index, indices, 0, indices.Length);
      topology = surface.topology;
    }
    lobe_surface_release(session, ref surface);

    if (changed) {
      mesh.Clear();
      mesh.SetVertexBufferParams(count / 3, new VertexAttributeDescriptor(VertexAttribute.Position, stream: 0),
                                 new VertexAttributeDescriptor(VertexAttribute.Normal, stream: 1));
    }
    mesh.SetVertexBufferData(positions, 0, 0, count, 0);
    mesh.SetVertexBufferData(normals, 0, 0, count, 1);
    if (changed) mesh.SetIndices(indices, MeshTopology.Triangles, 0);
    mesh.RecalculateBounds();
  }

  void OnDestroy() {
    if (session != IntPtr.Zero) lobe_close(session);
  }
}
