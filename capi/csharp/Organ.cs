// A body that is simulated in real time, for any program in C#: a session of lobe_c.h. Nothing here needs an
// engine.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Text;

namespace Lobe {

  // What a call could not do, in lobe's words.
  public sealed class LobeException : Exception {
    public readonly Status Status;
    internal LobeException(Status status, string message) : base(message) {
      Status = status;
    }
  }

  // The surface of a frame, in arrays of its own. Organ.Update() fills them again and allocates only where
  // their lengths change.
  public sealed class Surface {
    public ulong Frame, Topology;  // while Topology is the same, only Positions and Normals change
    public double Time;            // [s]
    public float[] Positions = new float[0], Normals = new float[0];  // 3 per vertex
    public int[] Indices = new int[0];                                // 3 per triangle
    public byte[] Regions = new byte[0];  // per triangle: the number of its model (docs/guide/regions.md)
    public byte[] Cut = new byte[0];  // per triangle: 1 opened by a blade, 2 by a cautery, 0 skin
  }

  // Methods throw LobeException. Any thread may call them. Dispose() closes the session once no other call on
  // it is under way.
  public sealed class Organ : IDisposable {
    const uint abi = 1;  // LOBE_ABI_VERSION of the header that Native.cs follows
    readonly SessionHandle session;

    // Opens a scene (docs/scene.md).
    public Organ(string sceneFile, Options options = default(Options)) {
      Prepare(ref options);
      Check(Native.lobe_open(sceneFile, ref options, out session));
    }
    Organ(string scene, string folder, Options options) {
      Prepare(ref options);
      Check(Native.lobe_open_text(scene, folder, ref options, out session));
    }
    // Opens the text of a scene. Its paths are relative to the folder.
    public static Organ FromText(string scene, string folder, Options options = default(Options)) {
      return new Organ(scene, folder, options);
    }
    public void Dispose() {
      session.Dispose();
    }

    // ---- Time

    public void Start() {
      Check(Native.lobe_start(session));
    }  // in a thread of its own, until Stop()
    public void Stop() {
      Check(Native.lobe_stop(session));
    }
    public void Advance(uint frames = 1) {
      Check(Native.lobe_advance(session, frames));
    }  // not while started
    public void Pause(bool paused) {
      Check(Native.lobe_pause(session, paused ? 1 : 0));
    }
    public void SetSpeed(double speed) {
      Check(Native.lobe_set_speed(session, speed));
    }
    public void Restart() {
      Check(Native.lobe_restart(session));
    }
    public void Back(double seconds) {
      Check(Native.lobe_back(session, seconds));
    }

    public State State {
      get {
        var state = new State { size = (uint)Marshal.SizeOf(typeof(State)) };
        Check(Native.lobe_get_state(session, ref state));
        return state;
      }
    }

    // The messages after the given number, which is moved on to the last of them. Each begins with its
    // number.
    public List<string> Messages(ref ulong after) {
      var messages = new List<string>();
      var buffer = new byte[4096];
      while (true) {
        ulong last = Native.lobe_messages(session, after, buffer, (uint)buffer.Length);
        if (last == after)
          return messages;
        after = last;
        int length = Array.IndexOf(buffer, (byte)0);
        string text = Encoding.UTF8.GetString(buffer, 0, length);
        messages.AddRange(text.Split(new[] { '\n' }, StringSplitOptions.RemoveEmptyEntries));
      }
    }

    // ---- Tools, each by a number of the caller's choice. What is asked for happens at the start of the next
    // frame.

    public void Grasp(uint tool, double[] point, double radius) {
      Check(Native.lobe_grasp(session, tool, Vector(point, 3), radius));
    }
    // Grasps where the ray enters the body.
    public void GraspRay(uint tool, double[] origin, double[] direction, double radius) {
      Check(Native.lobe_grasp_ray(session, tool, Vector(origin, 3), Vector(direction, 3), radius));
    }
    public void Cautery(uint tool, double[] tip, double radius) {  // switched off at first
      Check(Native.lobe_cautery(session, tool, Vector(tip, 3), radius));
    }
    public void Scalpel(uint tool, double[] tip, double[] heel) {  // switched off at first
      Check(Native.lobe_scalpel(session, tool, Vector(tip, 3), Vector(heel, 3)));
    }
    // Any tool but a grasp, as a scene describes it, with "at" in place of "path" (docs/c.md).
    public void Bring(uint tool, string json) {
      Check(Native.lobe_bring(session, tool, json));
    }
    public void Switch(uint tool, bool on) {
      Check(Native.lobe_switch(session, tool, on ? 1 : 0));
    }
    public void Move(uint tool, double[] pose) {  // position and unit quaternion x y z w
      Check(Native.lobe_move(session, tool, Vector(pose, 7)));
    }
    public void Release(uint tool) {
      Check(Native.lobe_release(session, tool));
    }

    // False: there is no such tool, or it holds nothing.
    public bool TryGetTool(uint tool, out Tool state) {
      state = new Tool { size = (uint)Marshal.SizeOf(typeof(Tool)) };
      return IsThere(Native.lobe_get_tool(session, tool, ref state));
    }

    // ---- Haptics: a thread per tool asks for the force at about 1 kHz

    public void AttachHaptic(uint tool, HapticDevice device = default(HapticDevice)) {
      device.size = (uint)Marshal.SizeOf(typeof(HapticDevice));
      Check(Native.lobe_haptic_attach(session, tool, ref device));
    }
    public void DetachHaptic(uint tool) {
      Check(Native.lobe_haptic_detach(session, tool));
    }
    // Writes the force of the device [N] at a position and velocity. A position of null: the device is not
    // there.
    public void HapticForce(uint tool, double[] x, double[] v, double[] f) {
      Check(Native.lobe_haptic_force(session, tool, x == null ? null : Vector(x, 3),
                                     v == null ? null : Vector(v, 3), Vector(f, 3)));
    }

    // ---- Surface and files

    // Copies the latest surface. False: it is the frame that `surface` already has, or there is none yet.
    public bool Update(Surface surface) {
      var latest = new NativeSurface { size = (uint)Marshal.SizeOf(typeof(NativeSurface)) };
      if (!IsThere(Native.lobe_surface_acquire(session, ref latest)))
        return false;
      try {
        if (surface.Positions.Length > 0 && surface.Frame == latest.frame &&
            surface.Topology == latest.topology)
          return false;
        Copy(ref latest, surface);
      } finally {
        Native.lobe_surface_release(session, ref latest);
      }
      return true;
    }

    public void SaveScene(string file) {
      Check(Native.lobe_save_scene(session, file));
    }  // for `lobe run`
    public void SaveRecording(string file) {
      Check(Native.lobe_save_recording(session, file));
    }  // for `lobe replay`
    public void Save(string file) {
      Check(Native.lobe_save(session, file));
    }  // for Restore()
    public void Restore(string file) {
      Check(Native.lobe_restore(session, file));
    }

    static void Copy(ref NativeSurface from, Surface to) {
      int vertices = (int)from.vertices, triangles = (int)from.triangles;
      bool changed = to.Topology != from.topology || to.Positions.Length != 3 * vertices;
      Fit(ref to.Positions, 3 * vertices);
      Fit(ref to.Normals, 3 * vertices);
      Marshal.Copy(from.position, to.Positions, 0, 3 * vertices);
      Marshal.Copy(from.normal, to.Normals, 0, 3 * vertices);
      if (changed) {
        Fit(ref to.Indices, 3 * triangles);
        Fit(ref to.Regions, triangles);
        Fit(ref to.Cut, triangles);
        Marshal.Copy(from.index, to.Indices, 0, 3 * triangles);
        Marshal.Copy(from.region, to.Regions, 0, triangles);
        Marshal.Copy(from.cut, to.Cut, 0, triangles);
      }
      to.Frame = from.frame;
      to.Topology = from.topology;
      to.Time = from.time;
    }

    static void Fit<T>(ref T[] array, int length) {
      if (array.Length != length)
        array = new T[length];
    }

    // Passes on an array that has the length that the library reads or writes.
    static double[] Vector(double[] array, int length) {
      if (array == null || array.Length != length)
        throw new ArgumentException("an array of " + length + " numbers is needed, not " +
                                    (array == null ? "null" : "one of " + array.Length));
      return array;
    }

    static void Prepare(ref Options options) {
      if (Native.lobe_abi_version() != abi)
        throw new LobeException(
            Status.BadInput,
            "the library lobe_c has interface " + Native.lobe_abi_version() + ", these sources have " + abi);
      options.size = (uint)Marshal.SizeOf(typeof(Options));
      options.Axes = options.Axes == null ? new double [12] : Vector(options.Axes, 12);
    }

    static void Check(Status status) {
      if (status != Status.Ok)
        throw new LobeException(status, LastError());
    }
    static bool IsThere(Status status) {
      if (status == Status.NotYet)
        return false;
      Check(status);
      return true;
    }
    static string LastError() {
      IntPtr text = Native.lobe_last_error();
      int length = 0;
      while (Marshal.ReadByte(text, length) != 0) ++length;
      var bytes = new byte[length];
      Marshal.Copy(text, bytes, 0, length);
      return Encoding.UTF8.GetString(bytes);
    }
  }

}  // namespace Lobe
