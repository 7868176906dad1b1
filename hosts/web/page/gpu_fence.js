/** Whether the graphics card has finished what it had been given when the fence was made; asking does not wait. */
export class GpuFence {
  constructor(gl) {
    this.gl = gl;
    this.sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
  }

  get passed() {
    const {gl, sync} = this;
    if (sync === null || gl.isContextLost()) return true;
    if (gl.getSyncParameter(sync, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
    gl.deleteSync(sync);
    this.sync = null;
    return true;
  }
}
