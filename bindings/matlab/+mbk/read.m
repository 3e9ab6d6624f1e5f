function recording = read(file, varargin)
% mbk.read  The channels of a recording, in SI units.
%
%   RECORDING = mbk.read(FILE, NAME, VALUE, ...) reads MAT, HDF5, CSV, C3D and the other formats of mbk. RECORDING has
%   a column for each channel under its name (hand_x, force_x, ...), the column time in seconds, units (a struct with
%   the unit of each), metadata (a cell array of names and values) and events (a struct array with time, name and
%   value). You can pass it to mbk.measure and the other functions.
%
%   Options for reading: 'channels', 'variable', 'trial', 'side', 'clock', 'rate', 'axes'.
%
%   Example
%     recording = mbk.read('log.mat');
%     plot(recording.time, recording.hand_x)
%     result = mbk.measure(recording);
  [signals, metadata, events] = mbk_mex('read', char(file), mbk.internal.option_texts(varargin));
  recording = struct();
  units = struct();
  for k = 1:numel(signals)
    recording.(signals(k).name) = signals(k).values;
    units.(signals(k).name) = signals(k).unit;
  end
  recording.units = units;
  recording.metadata = metadata;
  recording.events = events;
end
