function [result, info] = sensor(what, varargin)
% mbk.sensor  Subcommands of 'mbk sensor': calibrate, delay.
%
%   [RESULT, INFO] = mbk.sensor('calibrate', ..., NAME, VALUE, ...) runs 'mbk sensor calibrate'. After the name of the
%   subcommand come data (see 'help mbk.measure'), file names or other words, as a text or a cell array of several,
%   then options with their values. RESULT is the document of --json as a struct, or the text that the command prints.
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
  [result, info] = mbk.internal.run(['sensor ' char(what)], varargin);
end
