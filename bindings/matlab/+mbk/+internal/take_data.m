function [data, words, documents, rest] = take_data(inputs)
% Separates data from the options that follow. Data: file names; time, position, force etc. as arrays; a struct, table,
% timetable or iddata; or the second output of a function of mbk. rest: the options.
  data = struct('signals', [], 'metadata', {{}}, 'events', []);
  words = {};
  documents = {};
  rest = inputs;
  if isempty(inputs)
    return
  end
  first = inputs{1};
  if is_text(first)
    words = {char(first)};
    rest = inputs(2:end);
  elseif iscell(first) || isa(first, 'string')
    words = cell(1, numel(first));
    for k = 1:numel(first)
      if iscell(first)
        words{k} = char(first{k});
      else
        words{k} = char(first(k));
      end
    end
    rest = inputs(2:end);
  elseif isnumeric(first)
    count = 1;
    while count < numel(inputs) && isnumeric(inputs{count + 1})
      count = count + 1;
    end
    data.signals = of_arrays(inputs(1:count));
    rest = inputs(count + 1:end);
  else
    [data, documents] = of_one(data, first);
    rest = inputs(2:end);
    while ~isempty(rest) && isempty(data.signals) && is_document(rest{1})
      documents{end + 1} = rest{1}.text;
      rest = rest(2:end);
    end
  end
end

function yes = is_text(value)
  yes = ischar(value) || (isa(value, 'string') && numel(value) == 1);
end

function yes = is_document(value)
  yes = isstruct(value) && isfield(value, 'text') && isfield(value, 'exit_code');
end

function signals = of_arrays(arrays)
% (logs), or (t, x, F), (t, x, F, xr), (t, x, F, xr, a): columns, one for each axis.
  signals = struct('name', {}, 'unit', {}, 'values', {});
  if numel(arrays) == 1
    signals = added(signals, 'logs', '', arrays{1});
    return
  end
  if numel(arrays) < 3 || numel(arrays) > 5
    error('mbk:usage', ['there are %d arrays; give time, position and force, then optionally reference and ' ...
                        'acceleration'], numel(arrays));
  end
  t = arrays{1};
  signals = added(signals, 'time', 's', t(:));
  axes = min(size(arrays{2}));
  if axes == 1
    names = {{'x'}, {'F'}, {'xr'}, {'a'}};
  elseif axes == 2
    names = {{'x', 'y'}, {'Fx', 'Fy'}, {'xr', 'yr'}, {'ax', 'ay'}};
  else
    error('mbk:usage', 'position has %d columns; give one column per axis, for 1 or 2 axes', axes);
  end
  for k = 2:numel(arrays)
    columns = arrays{k};
    if isvector(columns)
      columns = columns(:);
    end
    if size(columns, 2) ~= axes || size(columns, 1) ~= numel(t)
      error('mbk:usage', 'input %d is %d x %d; with %d samples and %d axes it must be %d x %d', k, size(columns, 1), ...
            size(columns, 2), numel(t), axes, numel(t), axes);
    end
    for axis = 1:axes
      signals = added(signals, names{k - 1}{axis}, '', columns(:, axis));
    end
  end
end

function [data, documents] = of_one(data, given)
  documents = {};
  if is_document(given)
    documents = {given.text};
  elseif isa(given, 'timetable')
    data.signals = of_timetable(given);
  elseif isa(given, 'table')
    data.signals = of_columns(empty_signals(), given, given.Properties.VariableNames, given.Properties.VariableUnits);
  elseif isa(given, 'iddata') || (isstruct(given) && numel(given) == 1 && has_fields_of_iddata(given))
    data.signals = of_iddata(given);
  elseif isstruct(given) && numel(given) == 1
    data = of_struct(data, given);
  else
    error('mbk:usage', 'data have class %s; give file names, arrays, a struct, a table, a timetable or iddata', ...
          class(given));
  end
end

function signals = empty_signals()
  signals = struct('name', {}, 'unit', {}, 'values', {});
end

function data = of_struct(data, given)
% Fields are signals, except units, metadata and events, as mbk.read returns them.
  signals = empty_signals();
  names = fieldnames(given);
  for k = 1:numel(names)
    name = names{k};
    if strcmp(name, 'metadata')
      entries = given.metadata';
      data.metadata = entries(:)';
    elseif strcmp(name, 'events')
      data.events = given.events;
    elseif ~strcmp(name, 'units')
      unit = '';
      if isfield(given, 'units') && isfield(given.units, name)
        unit = given.units.(name);
      end
      signals = added(signals, name, unit, given.(name));
    end
  end
  data.signals = signals;
end

function signals = of_timetable(data)
  times = data.Properties.RowTimes;
  if isa(times, 'datetime')
    times = times - times(1);  % durations
  end
  signals = added(empty_signals(), 'time', 's', seconds(times));
  signals = of_columns(signals, data, data.Properties.VariableNames, data.Properties.VariableUnits);
end

function signals = of_columns(signals, data, names, units)
  for k = 1:numel(names)
    unit = '';
    if k <= numel(units)
      unit = units{k};
    end
    columns = data.(names{k});
    for c = 1:size(columns, 2)
      name = names{k};
      if size(columns, 2) > 1
        name = sprintf('%s_%d', name, c);
      end
      signals = added(signals, name, unit, columns(:, c));
    end
  end
end

function yes = has_fields_of_iddata(data)
  yes = all(isfield(data, {'OutputData', 'InputData', 'Ts'})) || all(isfield(data, {'y', 'u', 'Ts'}));
end

function signals = of_iddata(data)
% One evenly sampled experiment in the time domain: outputs and inputs by name, or y1, u1, ... without names.
  outputs = first_property(data, {'OutputData', 'y'});
  inputs = first_property(data, {'InputData', 'u'});
  step = property(data, 'Ts');
  if size(outputs, 1) == 1  % of a struct; iddata has columns
    outputs = outputs(:);
    inputs = inputs(:);
  end
  if iscell(outputs) || iscell(inputs) || iscell(step)
    error('mbk:usage', 'iddata has several experiments; give one, such as getexp(data, 1)');
  end
  if strcmpi(property(data, 'Domain'), 'Frequency')
    error('mbk:usage', 'iddata is in the frequency domain; give time-domain data');
  end
  if ~isnumeric(step) || ~isscalar(step) || ~(step > 0) || ~isfinite(step)
    error('mbk:usage', 'iddata has no sample time Ts; give time, position and force as arrays');
  end
  start = property(data, 'Tstart');
  if ~isscalar(start) || ~isfinite(start)
    start = 0;
  end
  seconds_of_unit = time_unit(property(data, 'TimeUnit'));
  time = (start + (0:size(outputs, 1) - 1)' * step) * seconds_of_unit;
  signals = added(empty_signals(), 'time', 's', time);
  signals = of_matrix(signals, outputs, property(data, 'OutputName'), 'y', property(data, 'OutputUnit'));
  signals = of_matrix(signals, inputs, property(data, 'InputName'), 'u', property(data, 'InputUnit'));
end

function value = property(data, name)
% Property of an object or struct; [] if it does not exist.
  try
    value = data.(name);
  catch
    value = [];
  end
end

function value = first_property(data, names)
  value = [];
  for k = 1:numel(names)
    if isempty(value)
      value = property(data, names{k});
    end
  end
end

function factor = time_unit(name)
% In seconds.
  names = {'', 'seconds', 'milliseconds', 'microseconds', 'nanoseconds', 'minutes', 'hours'};
  factors = [1, 1, 1e-3, 1e-6, 1e-9, 60, 3600];
  if isempty(name)
    name = '';
  end
  found = strcmp(char(name), names);
  if ~any(found)
    error('mbk:usage', ['TimeUnit %s is unknown; use seconds, milliseconds, microseconds, nanoseconds, minutes ' ...
                        'or hours'], char(name));
  end
  factor = factors(find(found, 1));
end

function signals = of_matrix(signals, values, names, letter, units)
% Names and units: a text or a cell array of texts.
  if ischar(names)
    names = {names};
  end
  if ischar(units)
    units = {units};
  end
  for c = 1:size(values, 2)
    name = sprintf('%s%d', letter, c);
    if numel(names) >= c && ~isempty(names{c})
      name = names{c};
    end
    unit = '';
    if numel(units) >= c
      unit = units{c};
    end
    signals = added(signals, name, unit, values(:, c));
  end
end

function signals = added(signals, name, unit, values)
  if ~(isnumeric(values) || islogical(values)) || ~isreal(values)
    error('mbk:usage', '%s has class %s; give real numbers', name, class(values));
  end
  signals(end + 1) = struct('name', char(name), 'unit', char(unit), 'values', full(double(values)));
end
