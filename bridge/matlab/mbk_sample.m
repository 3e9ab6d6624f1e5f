function sample = mbk_sample()
%MBK_SAMPLE  Empty sample with the measurements and status of a robot: fill it from the hardware.
%   time_s of this sample, on the robot's clock; encoder (counts, or angles in rad), force, acceleration; has_force,
%   has_acceleration: the sensors are present now; stop_pressed; motors_on, as the drives report; obeyed: drive.sequence
%   that the drives execute now; drives_measure, measured (version 2: from the currents, in the unit of the command);
%   fault: your own fault code, 0: none.
%#codegen
sample = struct('time_s', 0, 'encoder', [0 0], 'force', [0 0], 'acceleration', [0 0], 'has_force', false, ...
                'has_acceleration', false, 'stop_pressed', false, 'motors_on', false, 'obeyed', uint64(0), ...
                'drives_measure', false, 'measured', [0 0], 'fault', uint32(0));
end
