// The functions and structs of lobe_c.h, by their own names. Units, threads and errors are those of the
// header.
using System;
using System.Runtime.InteropServices;

namespace Lobe {

  public enum Status { Ok = 0, BadInput = 1, Busy = 2, NotYet = 3, WrongState = 4, Failed = 5 }

  [StructLayout(LayoutKind.Sequential)]
  public struct Options {
    internal uint size;
    public uint Threads;  // of the simulation, 1 … 256; 0 means 1
    public double Frame;  // length of a frame [s]; 0 means 1/120
    public double Speed;  // simulated seconds per second of the clock; 0 means 1
    public uint Unpaced;  // 1: frames do not wait for the clock
    public uint Paused;   // 1: the session begins paused
    // The rows of (A | t): a position x of lobe is A x + t in the engine. Null: the same axes.
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 12)]
    public double[] Axes;
  }

  [StructLayout(LayoutKind.Sequential)]
  public struct State {
    internal uint size;
    public uint Tetrahedra;
    public ulong Frame;            // number of the frame of the latest snapshot
    public double Time;            // simulated [s]
    public double RealTimeFactor;  // over the last half second; 0 while paused
    public uint Running;           // 0: paused
    public uint StandsStill;       // 1: no step is stable
  }

  [StructLayout(LayoutKind.Sequential)]
  public struct Tool {
    internal uint size;
    public uint Holds;     // 1: a grasp has taken hold, a cautery or scalpel is on
    public uint Vertices;  // that a grasp holds
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 7)]
    public double[] Pose;  // position, quaternion x y z w
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)]
    public double[] Force;  // on the tool [N]
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)]
    public double[] Torque;  // [N m]
  }

  [StructLayout(LayoutKind.Sequential)]
  public struct HapticDevice {
    internal uint size;
    internal uint unused;
    public double Force;      // largest force [N]; 0 means 3
    public double Torque;     // largest torque [N m]; 0 means 0.1
    public double Slew;       // fastest change of the force [N/s]; 0 means 200
    public double Stiffness;  // of the stiffest coupling [N/m]; 0 means 1000
    public double Damping;    // of its mechanics [N s/m]; 0 means 0.5
  }

  [StructLayout(LayoutKind.Sequential)]
  struct NativeSurface {
    public uint size, vertices, triangles;
    public ulong frame, topology;
    public double time;
    public IntPtr position, normal, index, region, cut, owner;
  }

  // A session. It is closed when no call on it is under way.
  sealed class SessionHandle : SafeHandle {
    SessionHandle() : base(IntPtr.Zero, true) {}
    public override bool IsInvalid {
      get { return handle == IntPtr.Zero; }
    }
    protected override bool ReleaseHandle() {
      Native.lobe_close(handle);
      return true;
    }
  }

  static class Native {
    const string library = "lobe_c";               // liblobe_c.so, lobe_c.dll
    const UnmanagedType text = (UnmanagedType)48;  // UTF-8 on every system; LPUTF8Str, where the name exists

    [DllImport(library)]
    internal static extern uint lobe_abi_version();
    [DllImport(library)]
    internal static extern IntPtr lobe_last_error();
    [DllImport(library)]
    internal static extern Status lobe_open([MarshalAs(text)] string file, ref Options options,
                                            out SessionHandle session);
    [DllImport(library)]
    internal static extern Status lobe_open_text([MarshalAs(text)] string scene,
                                                 [MarshalAs(text)] string folder, ref Options options,
                                                 out SessionHandle session);
    [DllImport(library)]
    internal static extern void lobe_close(IntPtr session);

    [DllImport(library)]
    internal static extern Status lobe_start(SessionHandle session);
    [DllImport(library)]
    internal static extern Status lobe_stop(SessionHandle session);
    [DllImport(library)]
    internal static extern Status lobe_advance(SessionHandle session, uint frames);
    [DllImport(library)]
    internal static extern Status lobe_pause(SessionHandle session, int paused);
    [DllImport(library)]
    internal static extern Status lobe_set_speed(SessionHandle session, double speed);
    [DllImport(library)]
    internal static extern Status lobe_restart(SessionHandle session);
    [DllImport(library)]
    internal static extern Status lobe_back(SessionHandle session, double seconds);
    [DllImport(library)]
    internal static extern Status lobe_get_state(SessionHandle session, ref State state);
    [DllImport(library)]
    internal static extern ulong lobe_messages(SessionHandle session, ulong after, byte[] text,
                                               uint capacity);

    [DllImport(library)]
    internal static extern Status lobe_grasp(SessionHandle session, uint tool, double[] point, double radius);
    [DllImport(library)]
    internal static extern Status lobe_grasp_ray(SessionHandle session, uint tool, double[] origin,
                                                 double[] direction, double radius);
    [DllImport(library)]
    internal static extern Status lobe_cautery(SessionHandle session, uint tool, double[] tip, double radius);
    [DllImport(library)]
    internal static extern Status lobe_scalpel(SessionHandle session, uint tool, double[] tip, double[] heel);
    [DllImport(library)]
    internal static extern Status lobe_bring(SessionHandle session, uint tool, [MarshalAs(text)] string json);
    [DllImport(library)]
    internal static extern Status lobe_switch(SessionHandle session, uint tool, int on);
    [DllImport(library)]
    internal static extern Status lobe_move(SessionHandle session, uint tool, double[] pose);
    [DllImport(library)]
    internal static extern Status lobe_release(SessionHandle session, uint tool);
    [DllImport(library)]
    internal static extern Status lobe_get_tool(SessionHandle session, uint tool, ref Tool state);

    [DllImport(library)]
    internal static extern Status lobe_haptic_attach(SessionHandle session, uint tool,
                                                     ref HapticDevice device);
    [DllImport(library)]
    internal static extern Status lobe_haptic_detach(SessionHandle session, uint tool);
    [DllImport(library)]
    internal static extern Status lobe_haptic_force(SessionHandle session, uint tool, double[] x, double[] v,
                                                    double[] f);

    [DllImport(library)]
    internal static extern Status lobe_surface_acquire(SessionHandle session, ref NativeSurface surface);
    [DllImport(library)]
    internal static extern void lobe_surface_release(SessionHandle session, ref NativeSurface surface);

    [DllImport(library)]
    internal static extern Status lobe_save_scene(SessionHandle session, [MarshalAs(text)] string file);
    [DllImport(library)]
    internal static extern Status lobe_save_recording(SessionHandle session, [MarshalAs(text)] string file);
    [DllImport(library)]
    internal static extern Status lobe_save(SessionHandle session, [MarshalAs(text)] string file);
    [DllImport(library)]
    internal static extern Status lobe_restore(SessionHandle session, [MarshalAs(text)] string file);
  }

}  // namespace Lobe
