% Tests the MATLAB functions against the bytes of vectors.txt and the reactions of rules.txt: octave-cli bridge_test.m
addpath(fileparts(mfilename('fullpath')));

function value = whole(text)
  % Digit by digit, because a double has only 53 bits.
  value = uint64(0);
  for digit = text
    value = value * 10 + uint64(digit - '0');
  end
end

function bytes = hex(text)
  bytes = uint8(hex2dec(reshape(text, 2, [])'))';
end

function all_lines = words_of(name)
  text = fileread(fullfile(fileparts(mfilename('fullpath')), '..', name));
  all_lines = {};
  for line = strsplit(text, "\n")
    if ~isempty(line{1}) && line{1}(1) ~= '#'
      all_lines{end + 1} = strsplit(strtrim(line{1}), ' ');
    end
  end
end

function command = command_of(words)
  command = struct('flags', whole(words{1}), 'session', whole(words{2}), 'watchdog_ms', whole(words{3}), ...
                   'sequence', whole(words{4}), 'command', str2double(words(5:6)));
end

function check_vector(words)
  kind = words{1};
  bytes = hex(words{end});
  if strcmp(kind, 'command')
    assert(mbk_pack_command(command_of(words(2:7))), bytes);
    [why, came] = mbk_unpack_command(bytes);
    assert(why, 0);
    assert(mbk_pack_command(came), bytes);
  elseif strcmp(kind, 'state')
    numbers = str2double(words(8:16));
    state = struct('version', whole(words{2}), 'flags', whole(words{3}), 'session', whole(words{4}), ...
                   'rejected', whole(words{5}), 'sequence', whole(words{6}), 'answered', whole(words{7}), ...
                   'time_s', numbers(1), 'encoder', numbers(2:3), 'force', numbers(4:5), ...
                   'acceleration', numbers(6:7), 'measured', numbers(8:9), 'fault', whole(words{17}));
    assert(mbk_pack_state(state), bytes);
    [why, came] = mbk_unpack_state(bytes);
    assert(why, 0);
    assert(mbk_pack_state(came), bytes);
  else
    whys = {'length', 'magic', 'version', 'checksum'};
    if strcmp(words{2}, 'command')
      why = mbk_unpack_command(bytes);
    else
      why = mbk_unpack_state(bytes);
    end
    assert(why, find(strcmp(whys, words{3})));
  end
end

function robot = check_rule(robot, words)
  kind = words{1};
  expected = words(find(strcmp(words, '->')) + 1:end);
  if strcmp(kind, 'begin')
    robot = struct('bridge', mbk_bridge_begin(str2double(words{2})), 'stop', false, ...
                   'drive', struct('enabled', false, 'command', [0 0], 'sequence', uint64(0)));
  elseif strcmp(kind, 'drive')
    robot.stop = strcmp(words{3}, '1');
    [robot.bridge, robot.drive] = mbk_bridge_drive(robot.bridge, 1e-3 * str2double(words{2}), robot.stop);
    assert(double(robot.drive.enabled), str2double(expected{1}));
    assert(robot.drive.command, str2double(expected(2:3)));
    assert(robot.drive.sequence, whole(expected{4}));
  elseif strcmp(kind, 'state')
    sample = mbk_sample();
    sample.time_s = 1.5;
    sample.encoder = [1 2];
    sample.force = [3 4];
    sample.acceleration = [5 6];
    sample.stop_pressed = robot.stop;
    sample.motors_on = robot.drive.enabled;
    sample.obeyed = robot.drive.sequence;
    sample.drives_measure = true;
    sample.measured = [7 8];
    sample.fault = uint32(9);
    [robot.bridge, bytes] = mbk_bridge_state(robot.bridge, sample);
    if strcmp(expected{1}, 'none')
      assert(~robot.bridge.awake);
      return
    end
    [why, came] = mbk_unpack_state(bytes);
    assert(why, 0);
    assert(robot.bridge.awake);
    assert(double(came.version), robot.bridge.version);
    assert([uint64(came.flags), uint64(came.session), uint64(came.rejected), came.sequence, came.answered], ...
           [whole(expected{1}), whole(expected{2}), whole(expected{3}), whole(expected{4}), whole(expected{5})]);
    assert([came.time_s, came.encoder, came.force, came.acceleration], [1.5 1 2 3 4 5 6]);
    if came.version == 2
      assert([came.measured, double(came.fault)], [7 8 9]);
    end
  else
    bytes = mbk_pack_command(command_of(words(4:9)));
    if strcmp(kind, 'damaged')
      bytes(end) = bitxor(bytes(end), uint8(128));
    end
    [robot.bridge, event] = mbk_bridge_take(robot.bridge, bytes, str2double(words{3}), 1e-3 * str2double(words{2}));
    events = {'rejected', 'greeted', 'commanded', 'repeated'};
    assert(events{event + 1}, expected{1});
  end
end

failures = 0;
steps = 0;
robot = struct();
for name = {'vectors.txt', 'rules.txt'}
  for line = words_of(name{1})
    steps = steps + 1;
    try
      if strcmp(name{1}, 'vectors.txt')
        check_vector(line{1});
      else
        robot = check_rule(robot, line{1});
      end
    catch error
      failures = failures + 1;
      fprintf(stderr, '%s: %s\n%s\n', name{1}, strjoin(line{1}, ' '), error.message);
    end
  end
end
printf('%d lines, %d failures\n', steps, failures);
assert(failures == 0 && steps > 90);

% the check value of the standard, and lengths that are not multiples of four
for known = {'', 0; 'a', 3904355907; 'ab', 2659403885; 'abc', 891568578; '123456789', 3421780262}'
  assert(mbk_crc32(reshape(uint8(known{1}), 1, [])), uint32(known{2}));
end

% the whole step, as a Simulink block calls it
step_sample = mbk_sample();
step_sample.motors_on = true;
[enabled, command, datagram, count] = mbk_robot_step(zeros(1, 44, 'uint8'), 0, step_sample, 0);
assert([enabled, command, count], [false, 0, 0, 0]);
greeting = struct('flags', 2, 'session', 7, 'watchdog_ms', 50, 'sequence', 1, 'command', [0 0]);
[enabled, ~, datagram, count] = mbk_robot_step(mbk_pack_command(greeting)', 44, step_sample, 0.001);
assert([enabled, count], [false, 112]);
asked = struct('flags', 1, 'session', 7, 'watchdog_ms', 50, 'sequence', 2, 'command', [0.5 -2]);
[enabled, command, datagram, count] = mbk_robot_step(mbk_pack_command(asked), 44, step_sample, 0.002);
assert([enabled, command], [true, 0.5, -2]);
[why, came] = mbk_unpack_state(datagram(1:count));
assert([why, double(came.flags), double(came.answered)], [0, 2, 2]);
[enabled, command] = mbk_robot_step(zeros(1, 44, 'uint8'), 0, step_sample, 0.06);
assert([enabled, command], [false, 0, 0]);
printf('the step is right\n');
