#ifndef POSEFUSION_WHEN
#define POSEFUSION_WHEN

// `if`, written as a loop of at most one turn. Drivers that run many invocations in lockstep on a CPU always execute
// both sides of an `if`, but leave a loop as soon as no lane needs it: rare, expensive work costs nothing where no lane
// needs it.
#define WHEN(condition) for (bool when_ = (condition); when_; when_ = false)

#endif
