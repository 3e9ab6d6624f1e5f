% A robot whose hardware is another robot, in lock-step, with its bytes on standard input and output. It is run by
% python/relay_test.py, which owns the sockets.   octave-cli relay_test.m
addpath(fileparts(mfilename('fullpath')));

function send(bytes, flag)
  fwrite(stdout, uint32(numel(bytes)) + flag, 'uint32', 'ieee-le');
  fwrite(stdout, bytes, 'uint8');
  fflush(stdout);
end

function [bytes, sender] = receive()
  head = fread(stdin, 2, 'uint32', 'ieee-le');
  if numel(head) < 2
    exit(0);
  end
  bytes = uint8(fread(stdin, head(1), 'uint8'))';
  sender = head(2);
end

bridge = mbk_bridge_begin(1);
answer = uint8([]);
command = struct('flags', 0, 'session', 0, 'watchdog_ms', 10000, 'sequence', uint64(0), 'command', [0 0]);
begin = tic();
while true
  [bytes, sender] = receive();
  [bridge, event] = mbk_bridge_take(bridge, bytes, sender, toc(begin));
  if event == 1 || event == 2
    [bridge, drive] = mbk_bridge_drive(bridge, toc(begin), false);
    command.sequence = command.sequence + 1;
    command.flags = double(drive.enabled);
    if event == 1
      command.sequence = uint64(1);
      command.flags = 6;
    end
    command.session = bridge.session;
    command.command = drive.command;
    send(mbk_pack_command(command), uint32(2147483648));
    [why, state] = mbk_unpack_state(receive());
    assert(why, 0);
    sample = mbk_sample();
    for name = {'time_s', 'encoder', 'force', 'acceleration'}
      sample.(name{1}) = state.(name{1});
    end
    sample.stop_pressed = bitand(state.flags, 1) ~= 0;
    sample.motors_on = bitand(state.flags, 2) ~= 0;
    sample.has_force = bitand(state.flags, 4) ~= 0;
    sample.has_acceleration = bitand(state.flags, 8) ~= 0;
    sample.obeyed = drive.sequence;
    [bridge, answer] = mbk_bridge_state(bridge, sample);
  end
  if event == 0
    send(uint8([]), uint32(0));
  else
    send(answer, uint32(0));
  end
end
